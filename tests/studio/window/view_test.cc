#include <QAction>
#include <QApplication>
#include <QDockWidget>
#include <QStatusBar>
#include <QTest>
#include <QToolTip>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "studio/motion_editor/joint_panel.h"
#include "studio/soles/sole_panel.h"
#include "tests/studio/window/view_fixture.h"
#include "tests/support/qt_tests.h"
#include "view/render/playback.h"

// The view of the window, and the mouse in it.
namespace koboshi::studio {

using test::kPatience_ms;
using test::kRoot;

class ViewTest final : public ViewFixture {
  Q_OBJECT

 private:
  void trigger_named(const char* name) {
    auto* action = window_->findChild<QAction*>(QLatin1String(name));
    QVERIFY2(action != nullptr, name);
    action->trigger();
  }

 private Q_SLOTS:
  void init() { show_window(); }
  void cleanup() { window_.reset(); }

  void shows_the_poses_around_a_step() {
    window_->open(kRoot / "robots/koboshi/motions/squat.yaml");
    RobotView& view = window_->view();
    const MotionRows& rows = window_->motion().editor().rows();
    std::vector<std::size_t> moves;
    for (std::size_t i = 0; i < rows.sections.front().row_count; ++i)
      if (rows.rows[i].kind == simulation::StepSource::Kind::kMove) moves.push_back(i);
    QVERIFY(moves.size() >= 3);
    window_->motion().show_row(moves[1]);
    QVERIFY(view.picture().drawn().ghosts.empty());
    QTest::keyClick(window_.get(), Qt::Key_O, Qt::ControlModifier | Qt::ShiftModifier);
    QCOMPARE(view.picture().drawn().ghosts.size(), std::size_t{2});
    for (const view::Ghost& ghost : view.picture().drawn().ghosts) {
      QVERIFY(ghost.opacity < 0.5F);
      QVERIFY(ghost.tints.front().share > 0.0F);
      // On the same soles.
      const auto distance_m = [&](const char* foot) {
        return (ghost.links[link(foot)].p_WL_m - pose_of(foot).p_WL_m).norm();
      };
      QVERIFY(std::min(distance_m("left_foot"), distance_m("right_foot")) < 1e-5F);
    }
    QVERIFY(view.picture().drawn().ghosts[0].tints[0].colour.red >
            view.picture().drawn().ghosts[1].tints[0].colour.red);
    trigger_named("onion/before/0");
    trigger_named("onion/after/2");
    const std::size_t after = std::min<std::size_t>(2, moves.size() - 2);
    QCOMPARE(view.picture().drawn().ghosts.size(), after);
    if (after == 2)
      QVERIFY(view.picture().drawn().ghosts[0].opacity > view.picture().drawn().ghosts[1].opacity);
    // They follow the selection, and are no target of a drag.
    window_->motion().show_row(moves.back());
    QVERIFY(view.picture().drawn().ghosts.empty());
    QVERIFY(!view.picture().has_ghost());
    window_->open(kRoot / "robots/koboshi/motions/bow.yaml");
    trigger_named("onion/before/1");
    window_->motion().show_row(2);
    save_picture("onion");
    QTest::keyClick(window_.get(), Qt::Key_O, Qt::ControlModifier | Qt::ShiftModifier);
    window_->motion().show_row(moves[0]);
    QVERIFY(view.picture().drawn().ghosts.empty());
  }

  void names_frames_and_axes_under_the_mouse() {
    window_->open(kRoot / "robots/koboshi/motions/squat.yaml");
    RobotView& view = window_->view();
    QTRY_VERIFY(place_of("left_forearm"));
    const auto place = [&](const Eigen::Vector3f& p_W_m) {
      const Eigen::Vector2d px =
          view::project(view.picture().camera(), view.width(), view.height(), p_W_m.cast<double>());
      return QPointF(px.x(), px.y()).toPoint();
    };
    const QPoint head = place(pose_of("head").p_WL_m);
    hover(head);
    QVERIFY(view.mark_text_at(head).isEmpty());
    action("Link frames")->trigger();
    hover(head);
    const double z_mm = 1000.0 * static_cast<double>(pose_of("head").p_WL_m.z());
    const QString text = view.mark_text_at(head);
    QVERIFY2(text.contains(QStringLiteral("Link head")) &&
                 text.contains(QStringLiteral("z %1 mm").arg(z_mm, 0, 'f', 1)),
             qPrintable(text));
    QCOMPARE(QToolTip::text(), text);
    hover({3, 3});
    QTRY_VERIFY(QToolTip::text() != text || !QToolTip::isVisible());
    action("Link frames")->trigger();
    action("Joint axes")->trigger();
    const double knee_deg = 57.29578 * window_->motion().editable_pose()[joint("left_knee")];
    const QString axis = view.mark_text_at(place(pose_of("left_shank").p_WL_m));
    QVERIFY2(axis.contains(QStringLiteral("Joint left_knee: %1°").arg(knee_deg, 0, 'f', 1)),
             qPrintable(axis));
  }

  void footprints_of_a_live_run_come_and_are_rewound() {
    open_scenario("walk.yaml");
    for (const char* other : {"Zero moment point", "Support polygon", "Pushes"}) action(other)->trigger();
    QVERIFY(action("Footprints")->isChecked());
    run_to(1'500'000);
    const std::size_t standing = window_->view().picture().drawn().marks.flat.size();
    QVERIFY(standing > 0);
    run_to(6'000'000);
    const std::size_t walking = window_->view().picture().drawn().marks.flat.size();
    QVERIFY2(walking > standing, qPrintable(QString::number(walking)));
    window_->run().set_cursor(1'500'000);
    window_->run().rewind_to_cursor();
    QTRY_COMPARE_WITH_TIMEOUT(window_->run().end_us(), std::uint64_t{1'500'000}, kPatience_ms);
    QTRY_COMPARE(window_->view().picture().drawn().marks.flat.size(), standing);
  }

  void soles_and_zmp_from_above() {
    open_scenario("walk.yaml");
    auto* dock = window_->findChild<QDockWidget*>(QStringLiteral("soles"));
    dock->raise();
    run_to(5'000'000);
    auto* panel = window_->findChild<SolePanel*>();
    QTRY_VERIFY(panel->picture());
    const view::Recording& recording = window_->run().recording();
    const std::size_t margin = *view::find_signal(recording, "true_zmp_margin");
    for (const std::uint64_t time_us : {std::uint64_t{1'000'000}, std::uint64_t{4'900'000}}) {
      window_->run().set_cursor(time_us);
      static_cast<void>(panel->grab());  // paints
      const double recorded_m =
          static_cast<double>(recording.samples[view::sample_at(recording, time_us)].values[margin]);
      QVERIFY2(panel->picture()->margin_m, qPrintable(QStringLiteral("%1 us, %2 corners, %3")
                                                          .arg(time_us)
                                                          .arg(panel->picture()->support_m.size())
                                                          .arg(recorded_m)));
      QVERIFY2(std::abs(*panel->picture()->margin_m - recorded_m) < 1e-3,
               qPrintable(QStringLiteral("%1 us: %2 m, recorded %3 m")
                              .arg(time_us)
                              .arg(*panel->picture()->margin_m)
                              .arg(recorded_m)));
      // Measured and true ZMP, centre of mass and capture point; in walking, the planned ZMP as well.
      QCOMPARE(panel->picture()->points.size(), std::size_t{time_us < 2'000'000 ? 4U : 5U});
    }
    // The point is painted where it is.
    const SolePoint& point = panel->picture()->points.back();
    const QImage seen = panel->grab().toImage();
    const QColor there =
        seen.pixelColor((panel->place_of(point.now_m) * panel->devicePixelRatioF()).toPoint());
    QCOMPARE(there.rgb(), panel->palette().color(QPalette::Text).rgb());
    save_picture("soles");
  }

  // Pictures of fixed states, for tests/gui/studio_pictures_test.py; KOBOSHI_REFERENCE names the folder. Each
  // comes with one that has changed, which the comparison has to notice.
  void reference_pictures() {
    const QString folder = qEnvironmentVariable("KOBOSHI_REFERENCE");
    if (folder.isEmpty()) return;
    const auto save_view = [&](const char* name) {
      RobotView& view = window_->view();
      view.setFixedSize(640, 480);
      view.look_at_robot();
      QTRY_VERIFY(view.rests());
      QVERIFY(view.grab().toImage().save(folder + u'/' + QLatin1String(name) + QStringLiteral(".png")));
    };
    const auto save_panel = [&](const char* name) {
      MotionPanel& motion = window_->motion();
      motion.setFixedSize(1100, 560);
      QTRY_VERIFY_WITH_TIMEOUT(!motion.editor().is_checking(), kPatience_ms);
      QTest::qWait(100);
      QVERIFY(motion.grab().save(folder + u'/' + QLatin1String(name) + QStringLiteral(".png")));
    };
    open_scenario("walk.yaml");
    run_to(5'200'000);
    window_->run().set_cursor(5'000'000);
    save_view("studio-walk");
    window_->run().set_cursor(5'150'000);
    save_view("studio-walk-changed");
    show_window();
    window_->open(kRoot / "robots/koboshi/motions/bow.yaml");
    window_->motion().show_row(1);
    window_->findChild<JointPanel*>()->joint_chosen(joint("right_hip_pitch"));
    save_panel("studio-motion");
    save_view("studio-pose-changed");
    action("Onion skin")->trigger();
    save_view("studio-pose");
    const JointAngle angle{joint("right_hip_pitch"), -1.2};
    window_->motion().drag_pose({&angle, 1});
    window_->motion().end_pose_drag();
    save_panel("studio-motion-changed");
  }
};

static const koboshi::test::AddQtTest<ViewTest> kViewTest;

}  // namespace koboshi::studio

int main(int argc, char** argv) {
  return koboshi::studio::test::run_in_application(argc, argv,
                                                   [&] { return koboshi::test::run_qt_tests(argc, argv); });
}

#include "view_test.moc"
