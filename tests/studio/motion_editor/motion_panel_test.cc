#include <QClipboard>
#include <QDoubleSpinBox>
#include <QDragEnterEvent>
#include <QDropEvent>
#include <QMimeData>
#include <QPushButton>
#include <QSignalSpy>
#include <QStyleFactory>
#include <QWheelEvent>

#include "studio/motion_editor/joint_panel.h"
#include "studio/motion_editor/message_line.h"
#include "studio/motion_editor/offer_bar.h"
#include "tests/studio/motion_editor/panel_fixture.h"
#include "tests/support/qt_tests.h"

// Edits of a motion in the table and the joints.
namespace koboshi::studio {

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

    // The wheel scrolls the panel. It turns only a slider that is chosen.
    const auto turn_wheel = [elbow] {
      const QPointF centre = elbow->rect().center();
      QWheelEvent wheel(centre, elbow->mapToGlobal(centre), {}, {0, 120}, Qt::NoButton, Qt::NoModifier,
                        Qt::NoScrollPhase, false);
      QApplication::sendEvent(elbow, &wheel);
    };
    elbow->clearFocus();
    turn_wheel();
    COMPARE_TEXT(text(), original);
    elbow->setFocus();
    turn_wheel();
    QVERIFY(text() != original);
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
    press("undo");
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
    QVERIFY(panel_->save());
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
    std::function<void()> go_on;
    panel_->set_guard([&](std::function<void()> begin) { go_on = std::move(begin); });
    action("new")->trigger();
    QCOMPARE(panel_->file(), file_);
    QVERIFY(go_on);
    go_on();
    QVERIFY(panel_->file().empty());
    QVERIFY(panel_->modified());
    QCOMPARE(model().rowCount(), 1);
    QVERIFY(panel_->save_as(in_folder("begun.yaml")));
    COMPARE_TEXT(text_of(in_folder("begun.yaml")), text());
    QVERIFY(!panel_->modified());
  }

  // The name under which a robot lists the motion.
  void names_the_motion() {
    open_copy("squat.yaml");
    auto* const name = panel_->findChild<QLineEdit*>(QStringLiteral("motion_name"));
    QCOMPARE(name->text(), QStringLiteral("squat"));
    const std::string original = text();
    name->setFocus();
    name->selectAll();
    QTest::keyClicks(name, QStringLiteral("deep bend"));
    QTest::keyClick(name, Qt::Key_Return);
    COMPARE_TEXT(text(), with(original, "name: squat", "name: \"deep bend\""));
    QVERIFY(panel_->save_as(in_folder("other.yaml")));
    QCOMPARE(name->text(), QStringLiteral("deep bend"));
    press("undo");
    QCOMPARE(name->text(), QStringLiteral("squat"));
    QKeyEvent accented(QEvent::KeyPress, Qt::Key_Eacute, Qt::NoModifier, QStringLiteral("é"));
    QApplication::sendEvent(name, &accented);  // QTest knows ASCII only
    QTest::keyClick(name, Qt::Key_Return);
    COMPARE_TEXT(text(), original);
    QCOMPARE(name->text(), QStringLiteral("squat"));
    QVERIFY(panel_->findChild<MessageLine*>()->text().contains(QStringLiteral("1 to 24 printable ASCII")));
    action("new")->trigger();
    QCOMPARE(name->text(), QStringLiteral("untitled"));
    QVERIFY(panel_->save_as(in_folder("wave_both.yaml")));
    QCOMPARE(name->text(), QStringLiteral("wave_both"));
    QVERIFY(text_of(in_folder("wave_both.yaml")).find("name: wave_both\n") != std::string::npos);
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

static const test::AddQtTest<MotionPanelTest> kMotionPanelTest;

}  // namespace koboshi::studio

#include "motion_panel_test.moc"
