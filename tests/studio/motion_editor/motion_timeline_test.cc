#include <QAbstractButton>
#include <QSignalSpy>
#include <ctime>
#include <functional>

#include "studio/motion_editor/joint_panel.h"
#include "studio/motion_editor/message_line.h"
#include "tests/studio/motion_editor/panel_fixture.h"
#include "tests/support/qt_tests.h"

// The timeline, the check in the background, and large motions.
namespace koboshi::studio {

class MotionTimelineTest final : public PanelFixture {
  Q_OBJECT

 private Q_SLOTS:
  void init() { prepare(); }
  void cleanup() { clean_up(); }

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
};

static const test::AddQtTest<MotionTimelineTest> kMotionTimelineTest;

}  // namespace koboshi::studio

#include "motion_timeline_test.moc"
