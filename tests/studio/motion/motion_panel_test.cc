#include "tools/studio/motion/motion_panel.h"

#include <QAbstractButton>
#include <QCheckBox>
#include <QClipboard>
#include <QDoubleSpinBox>
#include <QDragEnterEvent>
#include <QDropEvent>
#include <QMimeData>
#include <QProcess>
#include <QPushButton>
#include <QSignalSpy>
#include <QStyleFactory>
#include <ctime>
#include <functional>
#include <string_view>

#include "tests/studio/motion/panel_fixture.h"
#include "tools/studio/motion/joint_panel.h"
#include "tools/studio/motion/message_line.h"
#include "tools/studio/motion/offer_bar.h"

namespace koboshi::studio {

inline constexpr const char* kEditAndWait = "--edit-and-wait";

class MotionPanelTest final : public PanelFixture {
  Q_OBJECT

 private Q_SLOTS:
  void init() { prepare(); }
  void cleanup() { clean_up(); }

  void edits_reach_the_file_to_the_byte() {
    open_copy("wave.yaml");
    const std::string original = text_of(file_);
    std::vector<double> pose;
    connect(panel_.get(), &MotionPanel::pose_changed, this,
            [&](const std::vector<double>& angles) { pose = angles; });

    // A drag of a slider is one step of the history.
    panel_->show_row(1);
    QSlider* const elbow = slider("right_elbow");
    QStyleOptionSlider option;
    option.initFrom(elbow);
    option.orientation = Qt::Horizontal;
    option.minimum = elbow->minimum();
    option.maximum = elbow->maximum();
    option.sliderPosition = option.sliderValue = elbow->sliderPosition();
    const QRect handle =
        elbow->style()->subControlRect(QStyle::CC_Slider, &option, QStyle::SC_SliderHandle, elbow);
    QTest::mousePress(elbow, Qt::LeftButton, {}, handle.center());
    for (int i = 1; i <= 5; ++i) QTest::mouseMove(elbow, handle.center() + QPoint(2 * i, 0));
    QTest::mouseRelease(elbow, Qt::LeftButton, {}, handle.center() + QPoint(10, 0));
    QCOMPARE(undo_count(), std::size_t{1});
    QVERIFY(text() != original);
    QVERIFY(std::abs(pose.at(joint("right_elbow")) - elbow->value() / 100.0 * 3.14159265358979 / 180.0) <
            1e-4);
    press("undo");
    COMPARE_TEXT(text(), original);

    // A typed angle.
    auto* const box = panel_->findChild<JointPanel*>()->spin_box(joint("right_elbow"));
    box->setFocus();
    box->selectAll();
    QTest::keyClicks(box, QStringLiteral("-50"));
    QTest::keyClick(box, Qt::Key_Return);
    std::string expected = with(original, "right_elbow: -45", "right_elbow: -50");
    COMPARE_TEXT(text(), expected);
    // Undo in the spin box concerns the motion.
    QTest::keyClick(box, Qt::Key_Z, Qt::ControlModifier);
    COMPARE_TEXT(text(), original);
    press("redo");
    COMPARE_TEXT(text(), expected);

    type_into(0, StepModel::kTime, "1.75");
    expected = with(expected, "{pose: stand, time_s: 1.5}", "{pose: stand, time_s: 1.75}");
    COMPARE_TEXT(text(), expected);
    type_into(2, StepModel::kStep, "6");
    expected = with(expected, "times: 4", "times: 6");
    COMPARE_TEXT(text(), expected);

    panel_->show_row(0);
    press("insert_wait");
    expected = with(expected, "time_s: 1.75}\n", "time_s: 1.75}\n  - {wait_s: 0.5}\n");
    COMPARE_TEXT(text(), expected);
    QCOMPARE(table().currentIndex().row(), 1);

    // Scales by the bar in the panel.
    press("scale_time");
    auto* const scale = panel_->findChild<QDoubleSpinBox*>(QStringLiteral("scale"));
    QVERIFY(scale->isVisible());
    grab("scale_bar");
    scale->setValue(200);
    QTest::mouseClick(panel_->findChild<QPushButton*>(QStringLiteral("apply_scale")), Qt::LeftButton);
    QVERIFY(!scale->isVisible());
    expected = with(expected, "wait_s: 0.5", "wait_s: 1");
    COMPARE_TEXT(text(), expected);
    QTest::keyClick(&table(), Qt::Key_S, Qt::ControlModifier);
    QVERIFY(!panel_->modified());
    COMPARE_TEXT(text_of(file_), expected);

    // Ten edits, ten times undo: the bytes of the beginning.
    const char* const edits[]{"mirror", "duplicate", "insert_pose", "duplicate",
                              "delete", "move_up",   "insert_loop", "mirror_motion"};
    panel_->show_row(2);
    const std::size_t before = undo_count();
    for (const char* const name : edits) {
      const std::string last = text();
      press(name);
      QVERIFY2(text() != last, qPrintable(panel_->findChild<MessageLine*>()->text()));
    }
    panel_->show_row(3);
    type_into(0, StepModel::kTime, "2");
    type_into(0, StepModel::kTime, "2.25");
    QCOMPARE(undo_count(), before + 10);
    const std::string last = text();
    for (int i = 0; i < 10; ++i) press("undo");
    COMPARE_TEXT(text(), expected);
    QVERIFY(!panel_->modified());
    for (int i = 0; i < 10; ++i) press("redo");
    COMPARE_TEXT(text(), last);
    while (undo_count() > 0) press("undo");
    COMPARE_TEXT(text(), original);
  }

  void findings_mark_their_rows() {
    open_copy("wave.yaml");
    wait_for_check();
    for (int row = 0; row < model().rowCount(); ++row)
      QVERIFY2(finding(row).isEmpty(), qPrintable(finding(row)));
    // The compiler: too fast.
    type_into(1, StepModel::kTime, "0.02");
    QVERIFY2(finding(1).startsWith(u'M'), qPrintable(finding(1)));
    QVERIFY(finding(0).isEmpty());
    QVERIFY(!model().index(1, StepModel::kFinding).data(Qt::ToolTipRole).toString().isEmpty());
    press("undo");
    QVERIFY(finding(1).isEmpty());
    // The check, later: the pose falls.
    panel_->show_row(1);
    const std::size_t hip = joint("left_hip_pitch");
    panel_->findChild<JointPanel*>()->spin_box(hip)->setValue(-60);
    QTRY_VERIFY_WITH_TIMEOUT(finding(1).startsWith(u'C'), kPatience_ms);
    QVERIFY2(finding(0).isEmpty(), qPrintable(finding(0)));
    QVERIFY(!panel_->findChild<MessageLine*>()->text().isEmpty());
    // A click on the message leads to the step.
    panel_->show_row(6);
    QTest::keyClick(&table(), Qt::Key_F8, Qt::ShiftModifier);
    press("next_finding");
    grab("finding");
    QTest::mouseClick(panel_->findChild<QAbstractButton*>(QStringLiteral("message")), Qt::LeftButton);
    QVERIFY(!finding(table().currentIndex().row()).isEmpty());
    press("undo");
    QTRY_VERIFY_WITH_TIMEOUT(finding(1).isEmpty(), kPatience_ms);
  }

  void newer_edit_cancels_the_check() {
    open_copy("greet.yaml");
    BackgroundCheck other;
    QSignalSpy finished(&other, &BackgroundCheck::finished);
    const std::string large = text_of(large_motion());
    const std::string small = text_of(kMotions / "greet.yaml");
    // The first check has minutes of motion to play; the second one a few seconds.
    other.request({kRobot, "large.yaml", large});
    other.request({kRobot, "greet.yaml", small});
    QTRY_COMPARE_WITH_TIMEOUT(finished.count(), 1, kPatience_ms);
    const auto result = finished.at(0).at(0).value<std::shared_ptr<const CheckResult>>();
    QVERIFY2(result->error.empty(), result->error.c_str());
    QVERIFY(std::abs(result->duration_s - 4.9) < 0.011);
    QVERIFY(!other.is_running());
    // While it runs.
    other.request({kRobot, "large.yaml", with(large, "time_s: 1.5", "time_s: 1.25")});
    QTRY_VERIFY_WITH_TIMEOUT(other.has_begun(), kPatience_ms);
    other.request({kRobot, "greet.yaml", small});
    QTRY_COMPARE_WITH_TIMEOUT(finished.count(), 2, kPatience_ms);
    QCOMPARE(other.cancelled(), std::size_t{1});
    // A check that runs at the end does not outlive the panel.
    panel_->show_row(0);
    panel_->findChild<JointPanel*>()->spin_box(joint("head_tilt"))->setValue(5);
    QVERIFY(editor().is_checking());
    panel_.reset();
    QCoreApplication::processEvents();
  }

  void recovers_after_a_crash() {
    open_copy("wave.yaml");
    const std::string original = text();
    type_into(0, StepModel::kTime, "1.75");
    const std::string edited = text();
    QVERIFY(edited != original);
    auto* const timer = editor().findChild<QTimer*>();
    QVERIFY(timer != nullptr && timer->isActive());
    timer->setInterval(1);
    QTRY_VERIFY_WITH_TIMEOUT(!find_recovery_files().empty(), kPatience_ms);
    editor().keep_recovery();
    panel_.reset();
    COMPARE_TEXT(text_of(file_), original);

    open(file_);
    auto* const bar = panel_->findChild<OfferBar*>(QStringLiteral("recovery"));
    QVERIFY(bar->isVisible());
    COMPARE_TEXT(text(), original);
    grab("recovery");
    QTest::mouseClick(bar->findChild<QPushButton*>(QStringLiteral("Restore")), Qt::LeftButton);
    QVERIFY(!bar->isVisible());
    COMPARE_TEXT(text(), edited);
    QVERIFY(panel_->modified());
    QVERIFY(panel_->save());
    COMPARE_TEXT(text_of(file_), edited);
    panel_.reset();
    QVERIFY(find_recovery_files().empty());
    open(file_);
    QVERIFY(!panel_->findChild<OfferBar*>(QStringLiteral("recovery"))->isVisible());
  }

  // Another process edits and is killed; this one recovers what it wrote.
  void recovers_after_kill_9() {
    file_ = in_folder("wave.yaml");
    fs::copy_file(kMotions / "wave.yaml", file_);
    const std::string original = text_of(file_);
    QProcess editing;
    editing.start(QCoreApplication::applicationFilePath(),
                  {QLatin1String(kEditAndWait), QString::fromStdString(file_.string())});
    QVERIFY(editing.waitForStarted(kPatience_ms));
    QTRY_VERIFY_WITH_TIMEOUT(!find_recovery_files().empty(), kPatience_ms);
    editing.kill();
    QVERIFY(editing.waitForFinished(kPatience_ms));
    QCOMPARE(editing.exitStatus(), QProcess::CrashExit);
    COMPARE_TEXT(text_of(file_), original);

    open(file_);
    auto* const bar = panel_->findChild<OfferBar*>(QStringLiteral("recovery"));
    QVERIFY(bar->isVisible());
    QTest::mouseClick(bar->findChild<QPushButton*>(QStringLiteral("Restore")), Qt::LeftButton);
    QVERIFY(text() != original);
    QVERIFY(panel_->save());
    QVERIFY(text_of(file_).find("time_s: 1.75") != std::string::npos);
  }

  void recovers_a_motion_that_was_never_saved() {
    open_copy("greet.yaml");
    action("new")->trigger();
    type_into(0, StepModel::kTime, "1.75");
    const std::string begun = text();
    editor().findChild<QTimer*>()->setInterval(1);
    QTRY_VERIFY_WITH_TIMEOUT(!find_recovery_files().empty(), kPatience_ms);
    editor().keep_recovery();
    open(file_);
    auto* const bar = panel_->findChild<OfferBar*>(QStringLiteral("recovery"));
    QTest::mouseClick(bar->findChild<QPushButton*>(QStringLiteral("Restore")), Qt::LeftButton);
    COMPARE_TEXT(text(), begun);
    QVERIFY(panel_->file().empty());
    QVERIFY(panel_->modified());
  }

  void notices_changes_by_other_programs() {
    open_copy("wave.yaml");
    const std::string other = with(text(), "time_s: 1.5", "time_s: 2.5");
    auto* const bar = panel_->findChild<OfferBar*>(QStringLiteral("disk"));
    QVERIFY(panel_->save());
    QVERIFY(!bar->isVisible());
    write(file_, other);
    QTRY_VERIFY_WITH_TIMEOUT(bar->isVisible(), kPatience_ms);
    // Save does not overwrite it unasked.
    type_into(1, StepModel::kTime, "1.25");
    QVERIFY(!panel_->save());
    QVERIFY(panel_->findChild<MessageLine*>()->text().startsWith(QStringLiteral("Not saved")));
    COMPARE_TEXT(text_of(file_), other);
    const std::string mine = text();
    for (auto* const button : bar->findChildren<QPushButton*>()) {
      if (button->text().startsWith(QStringLiteral("Reload")) && button->isVisible()) {
        QTest::mouseClick(button, Qt::LeftButton);
        break;
      }
    }
    COMPARE_TEXT(text(), other);
    QVERIFY(!panel_->modified());
    press("undo");
    COMPARE_TEXT(text(), mine);
    press("redo");
    // A file that is replaced, as editors do it, and then removed.
    write(in_folder("new"), with(other, "time_s: 2.5", "time_s: 3.5"));
    fs::rename(in_folder("new"), file_);
    QTRY_VERIFY_WITH_TIMEOUT(bar->isVisible(), kPatience_ms);
    QTest::mouseClick(bar->findChild<QPushButton*>(QStringLiteral("Overwrite")), Qt::LeftButton);
    COMPARE_TEXT(text_of(file_), other);
    fs::remove(file_);
    QTRY_VERIFY_WITH_TIMEOUT(bar->isVisible(), kPatience_ms);
    QVERIFY(panel_->save());
    COMPARE_TEXT(text_of(file_), other);
    QVERIFY(!bar->isVisible());
  }

  void large_motion_repaints_what_changes() {
    open(large_motion("0.5"));
    QCOMPARE(model().rowCount(), kLargeSteps);
    QTRY_VERIFY_WITH_TIMEOUT(editor().checked() != nullptr, kPatience_ms);
    QSignalSpy changes(&model(), &QAbstractItemModel::dataChanged);
    QSignalSpy inserted(&model(), &QAbstractItemModel::rowsInserted);
    QSignalSpy removed(&model(), &QAbstractItemModel::rowsRemoved);
    QSignalSpy resets(&model(), &QAbstractItemModel::modelReset);
    // An angle is none of the table's cells.
    panel_->show_row(500);
    panel_->findChild<JointPanel*>()->spin_box(joint("head_tilt"))->setValue(7);
    QCOMPARE(undo_count(), std::size_t{1});
    QCOMPARE(changes.count(), 0);
    // A time: its row, and the start of those behind it.
    QVERIFY(model().setData(model().index(400, StepModel::kTime), 2.0, Qt::EditRole));
    QCOMPARE(changes.count(), 2);
    QCOMPARE(changes.at(0).at(0).toModelIndex(), model().index(400, StepModel::kTime));
    QCOMPARE(changes.at(0).at(1).toModelIndex(), model().index(400, StepModel::kTime));
    QCOMPARE(changes.at(1).at(0).toModelIndex(), model().index(401, StepModel::kStart));
    QCOMPARE(changes.at(1).at(1).toModelIndex(), model().index(kLargeSteps - 1, StepModel::kStart));
    changes.clear();
    // An inserted step is one inserted row; the others move along.
    panel_->show_row(700);
    press("insert_wait");
    QCOMPARE(inserted.count(), 1);
    QCOMPARE(inserted.at(0).at(1).toInt(), 701);
    QCOMPARE(inserted.at(0).at(2).toInt(), 701);
    QCOMPARE(changes.count(), 1);
    QCOMPARE(changes.at(0).at(0).toModelIndex(), model().index(702, StepModel::kStart));
    QCOMPARE(table().currentIndex().row(), 701);
    press("undo");
    QCOMPARE(removed.count(), 1);
    QCOMPARE(resets.count(), 0);
  }

  void timeline_selects_and_drags() {
    open_copy("wave.yaml");
    const std::string original = text();
    QWidget* const view = timeline().viewport();
    const QPoint key = timeline().key_point(1).toPoint();
    QTest::mousePress(view, Qt::LeftButton, {}, key);
    QCOMPARE(table().currentIndex().row(), 1);
    for (int i = 1; i <= 8; ++i) QTest::mouseMove(view, key + QPoint(5 * i, 0));
    QTest::mouseRelease(view, Qt::LeftButton, {}, key + QPoint(40, 0));
    QCOMPARE(undo_count(), std::size_t{1});
    const double time_s = editor().rows().rows[1].time_s.value();
    QVERIFY(time_s > 1.1);
    COMPARE_TEXT(text(), with(original, "{pose: arm_up, time_s: 1.0}",
                              "{pose: arm_up, time_s: " + QString::number(time_s).toStdString() + "}"));
    press("undo");
    COMPARE_TEXT(text(), original);
    // Two steps by clicks; a drag scales them.
    QTest::mouseClick(view, Qt::LeftButton, {}, timeline().key_point(0).toPoint());
    QTest::mouseClick(view, Qt::LeftButton, Qt::ControlModifier, key);
    QCOMPARE(table().selectionModel()->selectedRows().size(), 2);
    QTest::mousePress(view, Qt::LeftButton, {}, key);
    QTest::mouseMove(view, key + QPoint((key.x() - 44) / 2, 0));
    QTest::mouseMove(view, key + QPoint((key.x() - 44) / 2, 0));
    COMPARE_TEXT(text(), original);
    grab("scale");
    QTest::mouseRelease(view, Qt::LeftButton, {}, key + QPoint((key.x() - 44) / 2, 0));
    QCOMPARE(undo_count(), std::size_t{1});
    QVERIFY(std::abs(editor().rows().rows[0].time_s.value() - 2.25) < 0.02);
    QVERIFY(std::abs(editor().rows().rows[1].time_s.value() - 1.5) < 0.02);
    press("undo");
    // A box around all of them.
    QTest::mousePress(view, Qt::LeftButton, {}, QPoint(46, 24));
    QTest::mouseMove(view, QPoint(view->width() - 4, 60));
    QTest::mouseRelease(view, Qt::LeftButton, {}, QPoint(view->width() - 4, 60));
    QCOMPARE(table().selectionModel()->selectedRows().size(), 6);  // all but the loop
    // The check's pose at a time.
    wait_for_check();
    QSignalSpy poses(panel_.get(), &MotionPanel::pose_changed);
    QTest::mouseClick(view, Qt::LeftButton, {}, QPoint(200, 8));
    QCOMPARE(poses.count(), 1);
  }

  // The curves of a joint: what is said at the place, and that the torque is drawn where it is.
  void timeline_shows_the_torque_of_the_joint() {
    open_copy("squat.yaml");
    wait_for_check();
    panel_->findChild<JointPanel*>()->joint_chosen(joint("right_knee"));
    const CheckResult& result = *editor().checked();
    QCOMPARE(result.stall_torques_Nm.size(), result.joints);
    const std::size_t knee = joint("right_knee");
    QWidget* const view = timeline().viewport();
    const QPointF place(0.5 * view->width(), view->height() - 20);
    const QString tip = timeline().tip_at(place);
    QVERIFY2(tip.contains(QStringLiteral("N m of")), qPrintable(tip));
    bool named = false;
    for (const CheckedTick& tick : result.ticks) {
      if (tick.loads == nullptr) continue;
      const tools::ServoLoad& load = tick.loads->at(knee);
      QVERIFY(load.available_Nm > 0.0F);
      named = named || tip.contains(QStringLiteral("%1 N m of %2 N m")
                                        .arg(load.torque_Nm, 0, 'f', 2)
                                        .arg(load.available_Nm, 0, 'f', 2));
    }
    QVERIFY2(named, qPrintable(tip));
    const QImage with_knee = view->grab().toImage();
    grab("torque");
    panel_->findChild<JointPanel*>()->joint_chosen(joint("head_pan"));
    QVERIFY(view->grab().toImage() != with_knee);
    QVERIFY(!timeline().tip_at(place).contains(QStringLiteral("right_knee")));
  }

  // The drop is that of a drag within the table.
  void moves_rows_by_drag_and_drop() {
    open_copy("wave.yaml");
    const std::string original = text();
    const QString moved = cell(0, StepModel::kStep);
    const std::unique_ptr<QMimeData> data(model().mimeData({model().index(0, 0), model().index(0, 1)}));
    QVERIFY(table().dragEnabled() && table().viewport()->acceptDrops());
    const auto drop = [&](const QPoint& place) {
      const auto send = [&](QEvent&& event) { QApplication::sendEvent(table().viewport(), &event); };
      send(QDragEnterEvent(place, Qt::MoveAction, data.get(), Qt::LeftButton, Qt::NoModifier));
      send(QDragMoveEvent(place, Qt::MoveAction, data.get(), Qt::LeftButton, Qt::NoModifier));
      send(QDropEvent(QPointF(place), Qt::MoveAction, data.get(), Qt::LeftButton, Qt::NoModifier));
    };
    drop(table().visualRect(model().index(1, 0)).bottomLeft() + QPoint(30, 0));  // behind the second row
    QCOMPARE(cell(1, StepModel::kStep), moved);
    QCOMPARE(table().currentIndex().row(), 1);
    QCOMPARE(undo_count(), std::size_t{1});
    press("undo");
    COMPARE_TEXT(text(), original);
    QMimeData other;  // of another program
    other.setText(QStringLiteral("0"));
    QVERIFY(!model().dropMimeData(&other, Qt::MoveAction, 2, 0, {}));
  }

  // Steps without an editor of their own are edited as YAML; the compiler's message is in the same row.
  void edits_steps_as_yaml() {
    open_copy("rise_prone.yaml");
    const auto& rows = editor().rows().rows;
    const auto found = std::ranges::find(rows, simulation::StepSource::Kind::kExpect, &MotionRow::kind);
    QVERIFY(found != rows.end());
    const int row = static_cast<int>(found - rows.begin());
    const QModelIndex step = model().index(row, StepModel::kStep);
    QCOMPARE(step.data(Qt::EditRole).toString(), QStringLiteral("{pitch_deg: 90, within_deg: 50}"));
    const std::string original = text();
    type_into(row, StepModel::kStep, "{pitch_deg: 80, within_deg: 40}");
    COMPARE_TEXT(text(),
                 with(original, "{pitch_deg: 90, within_deg: 50}", "{pitch_deg: 80, within_deg: 40}"));
    type_into(row, StepModel::kStep, "{pitch_deg: 80, within_deg: 400}");
    QVERIFY2(finding(row).contains(QStringLiteral("400")), qPrintable(finding(row)));
    press("undo");
    press("undo");
    COMPARE_TEXT(text(), original);
    QVERIFY(!model().setData(step, QStringLiteral("{pitch_deg: "), Qt::EditRole));  // no YAML
    COMPARE_TEXT(text(), original);
    open_copy("balance.yaml");
    QCOMPARE(model().index(1, StepModel::kStep).data(Qt::EditRole).toString(),
             QStringLiteral("{ankle_pitch: {pitch_rate: 0.05, limit_deg: 3}}"));
  }

  void copies_into_another_motion() {
    open_copy("greet.yaml");
    panel_->show_row(0);
    table().selectAll();
    press("copy");
    QVERIFY(QApplication::clipboard()->text().contains(QStringLiteral("robot: koboshi")));
    const int copied = model().rowCount();
    file_ = in_folder("other.yaml");
    write(file_,
          "version: 2\nrobot: koboshi\nname: other\nposes:\n  up: {head_pan: 10}\nsteps:\n  - {pose: up, "
          "time_s: 1}   # first\n");
    open(file_);
    panel_->show_row(0);
    press("paste");
    QCOMPARE(model().rowCount(), 1 + copied);
    QCOMPARE(table().selectionModel()->selectedRows().size(), copied);
    QVERIFY(text().find("# first") != std::string::npos);
    QVERIFY(editor().document().compiled() != nullptr);
    // Another text is an error in the message line.
    QApplication::clipboard()->setText(QStringLiteral("no motion"));
    const std::string before = text();
    press("paste");
    COMPARE_TEXT(text(), before);
    QVERIFY(panel_->findChild<MessageLine*>()->text().contains(QStringLiteral("expected")));
  }

  void actions_have_shortcuts_and_tips() {
    open_copy("greet.yaml");
    QStringList seen;
    for (QAction* const one : panel_->edit_actions() + panel_->file_actions()) {
      if (one->isSeparator()) continue;
      QVERIFY2(!one->shortcut().isEmpty(), qPrintable(one->text()));
      QVERIFY2(!seen.contains(one->shortcut().toString()), qPrintable(one->text()));
      QVERIFY2(one->toolTip().contains(one->shortcut().toString(QKeySequence::NativeText)),
               qPrintable(one->text()));
      seen << one->shortcut().toString();
    }
    QSignalSpy plays(panel_.get(), &MotionPanel::play_requested);
    panel_->show_row(3);
    press("play_preview");
    press("play_physics");
    QCOMPARE(plays.count(), 2);
    QCOMPARE(plays.at(0), (QVariantList{false, 3}));
    QCOMPARE(plays.at(1), (QVariantList{true, 0}));
    // A motion that cannot be opened leaves the other one.
    const auto error = panel_->open(in_folder("none.yaml"), kRobot);
    QVERIFY(error && !error->contains(u'\n'));
    QCOMPARE(panel_->file(), file_);
    QCOMPARE(panel_->findChild<MessageLine*>()->text(), *error);
    QVERIFY(QApplication::activeModalWidget() == nullptr);
  }

  void edits_names_labels_and_conditions() {
    open_copy("greet.yaml");
    std::string expected = text();
    panel_->show_row(0);
    press("rename_pose");
    auto* const name = panel_->findChild<QLineEdit*>(QStringLiteral("pose"));
    QVERIFY(name->hasFocus());
    QTest::keyClicks(name, QStringLiteral("high"));
    QTest::keyClick(name, Qt::Key_Return);
    expected = with(
        with(with(with(expected, "  up:", "  high:"), "from: up", "from: high"), "from: up", "from: high"),
        "{pose: up", "{pose: high");
    COMPARE_TEXT(text(), expected);
    // Joints beyond the file's list keep their angles.
    QVERIFY(slider("right_elbow")->isEnabled());
    QVERIFY(!slider("left_elbow")->isEnabled());
    type_into(4, StepModel::kStep, "finish");
    COMPARE_TEXT(text(), with(expected, "label: down", "label: finish"));
    QVERIFY(editor().document().compiled() == nullptr);  // `exit` leads to the old name
    QVERIFY(panel_->findChild<MessageLine*>()->text().startsWith(u'M'));
    press("undo");
    file_ = in_folder("branch.yaml");
    const std::string branch =
        "version: 2\nrobot: koboshi\nname: branch\nsteps:\n  - if: roll_mdeg > 4000   # leans\n    then:\n   "
        "   - {wait_s: 1}\n";
    write(file_, branch);
    open(file_);
    type_into(0, StepModel::kStep, "roll_mdeg > 5000");
    COMPARE_TEXT(text(), with(branch, "4000", "5000"));
    QVERIFY(editor().document().compiled() != nullptr);
  }

  void begins_and_upgrades() {
    open_copy("wave.yaml");
    action("upgrade")->trigger();
    QVERIFY(text().find("version: 2") != std::string::npos);
    // Changes are not dropped unasked.
    auto* const bar = panel_->findChild<OfferBar*>(QStringLiteral("recovery"));
    action("new")->trigger();
    QVERIFY(bar->isVisible());
    QCOMPARE(panel_->file(), file_);
    QTest::mouseClick(bar->findChild<QPushButton*>(QStringLiteral("Cancel")), Qt::LeftButton);
    press("undo");
    action("new")->trigger();
    QVERIFY(!bar->isVisible());
    QVERIFY(panel_->file().empty());
    QVERIFY(panel_->modified());
    QCOMPARE(model().rowCount(), 1);
    QVERIFY(panel_->save_as(in_folder("begun.yaml")));
    COMPARE_TEXT(text_of(in_folder("begun.yaml")), text());
    QVERIFY(!panel_->modified());
  }

  // Prints the processor time of an edit and its repaint; not a test, as it depends on the machine.
  void speed_of_a_drag() {
    if (qEnvironmentVariableIsEmpty("KOBOSHI_GRAB")) QSKIP("KOBOSHI_GRAB names no folder");
    open(large_motion());
    QTRY_VERIFY_WITH_TIMEOUT(editor().checked() != nullptr, kPatience_ms);
    panel_->show_row(500);
    constexpr int kEdits = 50;
    const auto now_ms = [] {
      timespec time{};
      clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
      return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
    };
    const auto measure = [&](const char* what, const std::function<void(int)>& act) {
      const double start_ms = now_ms();
      for (int i = 0; i < kEdits; ++i) act(i);
      qInfo("%s: %.1f ms of processor time", what, (now_ms() - start_ms) / kEdits);
    };
    const std::size_t rows[]{500};
    auto& document = const_cast<MotionDocument&>(editor().document());
    const JointAngle angle{joint("head_pan"), 0.0};
    measure("angle, edit and repaint", [&](int i) {
      slider("head_pan")->setValue(100 * i + 50);
      panel_->repaint();
      QCoreApplication::processEvents();
    });
    measure("angle, edit", [&](int i) { slider("head_pan")->setValue(100 * i + 20); });
    measure("angle, document", [&](int i) {
      const JointAngle changed{angle.joint, 0.01 * i + 0.005};
      document.set_angles(500, {&changed, 1}, PoseScope::kAllSteps, "drag");
    });
    measure("time, edit and repaint", [&](int i) {
      editor().edit([&](MotionDocument& edited) { edited.set_time(rows, 1.0 + 0.01 * i, "drag"); });
      panel_->repaint();
      QCoreApplication::processEvents();
    });
    measure("repaint of the timeline", [&](int) { timeline().viewport()->repaint(); });
    measure("repaint of the table", [&](int) { table().viewport()->repaint(); });
    measure("repaint of the panel", [&](int) { panel_->repaint(); });
    wait_for_check();
    grab("large");
    timeline().zoom(40);
    grab("large_zoomed");
  }

  void looks_right() {
    if (qEnvironmentVariableIsEmpty("KOBOSHI_GRAB")) QSKIP("KOBOSHI_GRAB names no folder");
    const QPalette light = QApplication::palette();
    for (const bool dark : {false, true}) {
      QApplication::setStyle(QStyleFactory::create(QStringLiteral("Fusion")));
      QApplication::setPalette(dark ? dark_palette() : light);
      for (const char* const name : {"greet", "rise_prone", "balance", "wave", "squat"}) {
        open(kMotions / (std::string(name) + ".yaml"));
        wait_for_check();
        panel_->show_row(1);
        panel_->findChild<JointPanel*>()->joint_chosen(joint("right_knee"));
        QCoreApplication::processEvents();
        grab((std::string(name) + (dark ? "_dark" : "_light")).c_str());
      }
    }
    QApplication::setPalette(light);
    panel_->resize(640, 560);
    QCoreApplication::processEvents();
    qInfo("at least %d x %d", panel_->minimumSizeHint().width(), panel_->minimumSizeHint().height());
    grab("narrow");
  }
};

}  // namespace koboshi::studio

namespace koboshi::studio {

// Changes the first step's time as an edit of the panel, saves automatically, and waits to be killed.
static int edit_and_wait(const char* file) {
  MotionPanel panel;
  panel.show();
  if (panel.open(file, kRobot)) return 1;
  auto& editor = *panel.findChild<MotionEditor*>();
  editor.findChild<QTimer*>()->setInterval(1);
  const std::size_t first = 0;
  editor.edit([&](MotionDocument& document) { document.set_time({&first, 1}, 1.75); });
  return QApplication::exec();
}

}  // namespace koboshi::studio

int main(int argc, char** argv) {
  QApplication application(argc, argv);
  if (argc == 3 && std::string_view(argv[1]) == koboshi::studio::kEditAndWait)
    return koboshi::studio::edit_and_wait(argv[2]);
  koboshi::studio::MotionPanelTest test;
  return QTest::qExec(&test, argc, argv);
}

#include "motion_panel_test.moc"
