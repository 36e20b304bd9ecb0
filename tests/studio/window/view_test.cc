#include <QAction>
#include <QApplication>
#include <QDockWidget>
#include <QStatusBar>
#include <QSurfaceFormat>
#include <QTest>
#include <QToolTip>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/studio/window/view_fixture.h"
#include "tools/studio/motion/joint_panel.h"
#include "tools/studio/view/sole_panel.h"
#include "tools/view/render/playback.h"

// What is seen and done in the view of the window.
namespace koboshi::studio {

using test::kPatience_ms;
using test::kRoot;

class ViewTest final : public ViewFixture {
  Q_OBJECT

 private:
  std::size_t link(const char* name) {
    const auto& links = window_->view().scene().links;
    return static_cast<std::size_t>(std::ranges::find(links, std::string(name), &view::Link::name) -
                                    links.begin());
  }
  view::Pose pose_of(const char* name) { return window_->view().posed().at(link(name)); }
  void trigger_named(const char* name) {
    auto* action = window_->findChild<QAction*>(QLatin1String(name));
    QVERIFY2(action != nullptr, name);
    action->trigger();
  }
  // A run with a motion whose pose is a ghost in the place of the robot.
  void open_with_ghost() {
    open_scenario("walk.yaml");
    run_to(1'000'000);
    window_->open(kRoot / "robots/koboshi/motions/squat.yaml");
    QTRY_VERIFY(window_->view().has_ghost());
    run_to(1'010'000);
  }

 private Q_SLOTS:
  void init() { show_window(); }
  void cleanup() { window_.reset(); }

  void drags_a_hand() {
    window_->open(kRoot / "robots/koboshi/motions/squat.yaml");
    MotionPanel& motion = window_->motion();
    const std::string before = motion.text();
    const std::vector<double> pose = motion.editable_pose();
    QVERIFY(!pose.empty());
    const auto undo_count = [&] { return motion.editor().document().history().undo_count(); };
    const std::size_t undos = undo_count();
    QTRY_VERIFY(place_of("left_forearm"));
    drag(*place_of("left_forearm"), {40, -60});
    const std::vector<double> dragged = motion.editable_pose();
    QVERIFY(std::abs(dragged[joint("left_shoulder_roll")] - pose[joint("left_shoulder_roll")]) > 0.02 ||
            std::abs(dragged[joint("left_shoulder_pitch")] - pose[joint("left_shoulder_pitch")]) > 0.02);
    for (const char* kept : {"left_knee", "right_knee", "right_elbow", "head_pan"})
      QCOMPARE(dragged[joint(kept)], pose[joint(kept)]);
    QVERIFY(motion.text() != before);
    QCOMPARE(undo_count(), undos + 1);
    save_picture("drag-hand");
    motion.findChild<QAction*>(QStringLiteral("undo"))->trigger();
    QCOMPARE(motion.text(), before);
  }

  void drags_the_trunk_with_both_feet_on_the_ground() {
    window_->open(kRoot / "robots/koboshi/motions/squat.yaml");
    MotionPanel& motion = window_->motion();
    RobotView& view = window_->view();
    QTRY_VERIFY(place_of("trunk"));
    const auto before = view.posed();
    const auto soles = view.scene().sole_links;
    drag(*place_of("trunk"), {0, 30});
    const auto after = view.posed();
    QVERIFY(after[0].p_WL_m.z() < before[0].p_WL_m.z() - 0.002F);
    for (const int sole : soles) {
      const auto link = static_cast<std::size_t>(sole);
      QVERIFY((after[link].p_WL_m - before[link].p_WL_m).norm() < 1e-4F);
    }
    // The right button turns the view, also from the robot.
    const std::string text = motion.text();
    const double azimuth = view.camera().azimuth_rad;
    const QPoint place = *place_of("trunk");
    QTest::mousePress(&view, Qt::RightButton, {}, place);
    QMouseEvent move(QEvent::MouseMove, QPointF(place) + QPointF(50, 0),
                     view.mapToGlobal(QPointF(place) + QPointF(50, 0)), Qt::NoButton, Qt::RightButton, {});
    QApplication::sendEvent(&view, &move);
    QTest::mouseRelease(&view, Qt::RightButton, {}, place);
    QVERIFY(view.camera().azimuth_rad != azimuth);
    QCOMPARE(motion.text(), text);
  }

  void drags_along_an_axis_of_the_gizmo() {
    window_->open(kRoot / "robots/koboshi/motions/squat.yaml");
    RobotView& view = window_->view();
    QTRY_VERIFY(place_of("left_forearm"));
    QVERIFY(!view.gizmo());
    const QPoint hand = *place_of("left_forearm");
    hover(hand);
    QTRY_VERIFY(view.gizmo());
    save_picture("gizmo");
    const Gizmo arrows = *view.gizmo();
    const Eigen::Vector2d tip_px =
        view::project(view.camera(), view.width(), view.height(),
                      arrows.p_W_m + 0.9 * arrows.length_m * Eigen::Vector3d::UnitZ());
    const QPoint tip = QPointF(tip_px.x(), tip_px.y()).toPoint();
    hover(tip);
    QCOMPARE(view.gizmo_axis_at(tip), std::optional<int>(2));
    drag(tip, {0, -15});
    const Eigen::Vector3d moved_m = view.gizmo()->p_W_m - arrows.p_W_m;
    QVERIFY2(moved_m.z() > 0.003, qPrintable(QString::number(moved_m.z())));
  }

  // Far below the ground: the knees are bent as far as they go.
  void recolours_the_limbs_at_their_limits() {
    window_->open(kRoot / "robots/koboshi/motions/squat.yaml");
    RobotView& view = window_->view();
    QTRY_VERIFY(place_of("trunk"));
    const QPoint place = *place_of("trunk");
    QTest::mousePress(&view, Qt::LeftButton, {}, place);
    const QPointF far = QPointF(place) + QPointF(0, 500);
    QMouseEvent move(QEvent::MouseMove, far, view.mapToGlobal(far), Qt::NoButton, Qt::LeftButton, {});
    QApplication::sendEvent(&view, &move);
    const QString told = window_->statusBar()->currentMessage();
    const std::vector<view::Tint> tints = view.picture().tints;
    save_picture("limit");
    QTest::mouseRelease(&view, Qt::LeftButton, {}, far.toPoint());
    QVERIFY2(
        told.contains(QStringLiteral("Out of reach by")) && told.contains(QStringLiteral("At the limit")),
        qPrintable(told));
    QCOMPARE(tints.size(), view.scene().links.size());
    const auto share = [&](const char* name) {
      const auto& links = view.scene().links;
      const auto found = std::ranges::find(links, std::string(name), &view::Link::name);
      return tints[static_cast<std::size_t>(found - links.begin())].share;
    };
    for (const char* name : {"left_thigh", "right_thigh", "left_foot"}) QVERIFY2(share(name) > 0.0F, name);
    for (const char* name : {"trunk", "head", "left_forearm"}) QVERIFY2(share(name) == 0.0F, name);
    QVERIFY(view.picture().tints.empty());
  }

  void rotates_a_foot_with_control_and_shift() {
    window_->open(kRoot / "robots/koboshi/motions/squat.yaml");
    MotionPanel& motion = window_->motion();
    QTRY_VERIFY(place_of("left_foot"));
    const view::Pose foot = pose_of("left_foot");
    const view::Pose support = pose_of("right_foot");
    const QPoint place = *place_of("left_foot");
    const Hit hit = *window_->view().posable_at(place);
    const auto grabbed_m = [&] {
      const view::Pose pose = pose_of("left_foot");
      return Eigen::Vector3d(pose.p_WL_m.cast<double>() + pose.q_WL.cast<double>() * hit.p_L_m);
    };
    const Eigen::Vector3d before_m = grabbed_m();
    const std::size_t undos = motion.editor().document().history().undo_count();
    drag(place, {30, 0}, Qt::ControlModifier | Qt::ShiftModifier);
    const auto turned_rad = static_cast<double>(pose_of("left_foot").q_WL.angularDistance(foot.q_WL));
    // Half a turn across the height of the picture.
    const double asked_rad = 30.0 * std::numbers::pi / window_->view().height();
    QVERIFY2(std::abs(turned_rad - asked_rad) < 0.02, qPrintable(QString::number(turned_rad)));
    QVERIFY((grabbed_m() - before_m).norm() < 1e-3);
    QVERIFY((pose_of("right_foot").p_WL_m - support.p_WL_m).norm() < 1e-4F);
    QCOMPARE(motion.editor().document().history().undo_count(), undos + 1);
    // Nothing is pushed or turned instead.
    QVERIFY(window_->run().recording().pushes.empty());
  }

  void keeps_the_chosen_support_foot() {
    window_->open(kRoot / "robots/koboshi/motions/squat.yaml");
    MotionPanel& motion = window_->motion();
    QTRY_VERIFY(place_of("left_foot"));
    const auto dragged = [&](const char* foot, const char* support) {
      action(support)->trigger();
      const std::string text = motion.text();
      const view::Pose left = pose_of("left_foot");
      const view::Pose right = pose_of("right_foot");
      drag(*place_of(foot), {0, -15});
      const bool changed = motion.text() != text;
      const bool is_left = std::string(foot) == "left_foot";
      const view::Pose kept = pose_of(is_left ? "right_foot" : "left_foot");
      const bool is_kept = (kept.p_WL_m - (is_left ? right : left).p_WL_m).norm() < 1e-4F;
      if (changed) motion.findChild<QAction*>(QStringLiteral("undo"))->trigger();
      return changed && is_kept;
    };
    QVERIFY(dragged("left_foot", "Support: lower foot"));
    QVERIFY(dragged("left_foot", "Support: right foot"));
    QVERIFY(dragged("right_foot", "Support: left foot"));
    // A support foot is not dragged; the status line says so.
    QVERIFY(!dragged("left_foot", "Support: left foot"));
    QVERIFY(window_->statusBar()->currentMessage().contains(QStringLiteral("support")));
    QVERIFY(!dragged("right_foot", "Support: right foot"));
    QVERIFY(!dragged("right_foot", "Support: both feet"));
  }

  void drags_the_ghost_of_a_run() {
    open_with_ghost();
    MotionPanel& motion = window_->motion();
    RobotView& view = window_->view();
    QTRY_VERIFY(place_of("left_forearm"));
    const std::string text = motion.text();
    const std::vector<double> pose = motion.editable_pose();
    const std::vector<view::Pose> robot = view.picture().links;
    const view::Pose foot = pose_of("right_foot");
    const std::size_t elbow = joint("left_elbow");
    drag(*place_of("left_forearm"), {40, -40});
    QVERIFY(motion.text() != text);
    const std::vector<double> after = motion.editable_pose();
    QVERIFY(std::abs(after[elbow] - pose[elbow]) +
                std::abs(after[joint("left_shoulder_pitch")] - pose[joint("left_shoulder_pitch")]) >
            0.05);
    QVERIFY((pose_of("right_foot").p_WL_m - foot.p_WL_m).norm() < 1e-4F);
    // The robot of the run stays, and is not pushed.
    for (std::size_t i = 0; i < robot.size(); ++i) QCOMPARE(view.picture().links[i].p_WL_m, robot[i].p_WL_m);
    QVERIFY(window_->run().recording().pushes.empty());
    save_picture("drag-ghost");
  }

  void shows_the_poses_around_a_step() {
    window_->open(kRoot / "robots/koboshi/motions/squat.yaml");
    RobotView& view = window_->view();
    const MotionRows& rows = window_->motion().editor().rows();
    std::vector<std::size_t> moves;
    for (std::size_t i = 0; i < rows.sections.front().row_count; ++i)
      if (rows.rows[i].kind == simulation::StepSource::Kind::kMove) moves.push_back(i);
    QVERIFY(moves.size() >= 3);
    window_->motion().show_row(moves[1]);
    QVERIFY(view.picture().ghosts.empty());
    QTest::keyClick(window_.get(), Qt::Key_O, Qt::ControlModifier | Qt::ShiftModifier);
    QCOMPARE(view.picture().ghosts.size(), std::size_t{2});
    for (const view::Ghost& ghost : view.picture().ghosts) {
      QVERIFY(ghost.opacity < 0.5F);
      QVERIFY(ghost.tints.front().share > 0.0F);
      // On the same soles.
      const auto distance_m = [&](const char* foot) {
        return (ghost.links[link(foot)].p_WL_m - pose_of(foot).p_WL_m).norm();
      };
      QVERIFY(std::min(distance_m("left_foot"), distance_m("right_foot")) < 1e-5F);
    }
    QVERIFY(view.picture().ghosts[0].tints[0].colour.red > view.picture().ghosts[1].tints[0].colour.red);
    trigger_named("onion/before/0");
    trigger_named("onion/after/2");
    const std::size_t after = std::min<std::size_t>(2, moves.size() - 2);
    QCOMPARE(view.picture().ghosts.size(), after);
    if (after == 2) QVERIFY(view.picture().ghosts[0].opacity > view.picture().ghosts[1].opacity);
    // They follow the selection, and are no target of a drag.
    window_->motion().show_row(moves.back());
    QVERIFY(view.picture().ghosts.empty());
    QVERIFY(!view.has_ghost());
    window_->open(kRoot / "robots/koboshi/motions/bow.yaml");
    trigger_named("onion/before/1");
    window_->motion().show_row(2);
    save_picture("onion");
    QTest::keyClick(window_.get(), Qt::Key_O, Qt::ControlModifier | Qt::ShiftModifier);
    window_->motion().show_row(moves[0]);
    QVERIFY(view.picture().ghosts.empty());
  }

  void names_frames_and_axes_under_the_mouse() {
    window_->open(kRoot / "robots/koboshi/motions/squat.yaml");
    RobotView& view = window_->view();
    QTRY_VERIFY(place_of("left_forearm"));
    const auto place = [&](const Eigen::Vector3f& p_W_m) {
      const Eigen::Vector2d px =
          view::project(view.camera(), view.width(), view.height(), p_W_m.cast<double>());
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
    const std::size_t standing = window_->view().picture().marks.flat.size();
    QVERIFY(standing > 0);
    run_to(6'000'000);
    const std::size_t walking = window_->view().picture().marks.flat.size();
    QVERIFY2(walking > standing, qPrintable(QString::number(walking)));
    window_->run().set_cursor(1'500'000);
    window_->run().rewind_to_cursor();
    QTRY_COMPARE_WITH_TIMEOUT(window_->run().end_us(), std::uint64_t{1'500'000}, kPatience_ms);
    QTRY_COMPARE(window_->view().picture().marks.flat.size(), standing);
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
      QVERIFY(view.grabFramebuffer().save(folder + u'/' + QLatin1String(name) + QStringLiteral(".png")));
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

}  // namespace koboshi::studio

int main(int argc, char** argv) {
  return koboshi::studio::test::run_window_test<koboshi::studio::ViewTest>(argc, argv);
}

#include "view_test.moc"
