#include <QAction>
#include <QApplication>
#include <QStatusBar>
#include <QTest>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "tests/studio/window/view_fixture.h"
#include "tests/support/qt_tests.h"

// Drags of the edited pose in the view.
namespace koboshi::studio {

using test::kRoot;

class PoseDragTest final : public ViewFixture {
  Q_OBJECT

 private:
  // A run with a motion whose pose is a ghost in the place of the robot.
  void open_with_ghost() {
    open_scenario("walk.yaml");
    run_to(1'000'000);
    window_->open(kRoot / "robots/koboshi/motions/squat.yaml");
    QTRY_VERIFY(window_->view().picture().has_ghost());
    run_to(1'010'000);
  }
  QPoint place_of_point(const Eigen::Vector3d& p_W_m) {
    const RobotView& view = window_->view();
    const Eigen::Vector2d px = view::project(view.picture().camera(), view.width(), view.height(), p_W_m);
    return QPointF(px.x(), px.y()).toPoint();
  }
  // The rings leave most of the foot to be grabbed, also in a small view.
  void expect_body_between(const Gizmo& gizmo) {
    RobotView& view = window_->view();
    int all = 0;
    int on_ring = 0;
    const QPoint centre = place_of_point(gizmo.p_W_m);
    for (int dy = -80; dy <= 80; dy += 4)
      for (int dx = -80; dx <= 80; dx += 4) {
        const QPointF place(centre + QPoint(dx, dy));
        const auto hit = view.posable_at(place);
        if (!hit || hit->link != static_cast<int>(link("left_foot"))) continue;
        ++all;
        const auto handle = view.gizmo_handle_at(place);
        on_ring += handle && handle->kind == Handle::Kind::kRing ? 1 : 0;
      }
    QVERIFY(all > 50);
    QVERIFY2(3 * on_ring < all, qPrintable(QStringLiteral("%1 of %2").arg(on_ring).arg(all)));
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

  // A press some pixels beside a hand grabs it; the camera turns where nothing is near.
  void a_near_miss_grabs() {
    window_->open(kRoot / "robots/koboshi/motions/squat.yaml");
    MotionPanel& motion = window_->motion();
    RobotView& view = window_->view();
    QTRY_VERIFY(place_of("left_forearm"));
    const auto is_free = [&](const QPoint& place) {
      return !view.link_at(place) && !view.gizmo_handle_at(place);
    };
    std::optional<QPoint> beside;
    for (QPoint place = *place_of("left_forearm"); view.rect().contains(place) && !beside; place.rx() += 1)
      if (is_free(place)) beside = place + QPoint(4, 0);
    QVERIFY(beside && is_free(*beside));
    const std::string before = motion.text();
    const double azimuth = view.picture().camera().azimuth_rad;
    drag(*beside, {30, -40});
    QVERIFY(motion.text() != before);
    QCOMPARE(view.picture().camera().azimuth_rad, azimuth);
    drag({5, 5}, {30, 0});
    QVERIFY(view.picture().camera().azimuth_rad != azimuth);
  }

  void the_camera_stays_above_the_floor() {
    window_->open(kRoot / "robots/koboshi/motions/squat.yaml");
    RobotView& view = window_->view();
    QTRY_VERIFY(place_of("left_forearm"));
    const view::Camera at_first = view.picture().camera();
    for (int i = 0; i < 4; ++i) {
      drag({5, view.height() - 5}, {20, 10 - view.height()});
      drag({5, view.height() - 5}, {20, 10 - view.height()}, Qt::ShiftModifier);
      QVERIFY(view.picture().camera().eye_W_m().z() > 0.0199);
      QVERIFY(view.picture().camera().target_W_m.z() > -1e-9);
    }
    QTest::keyClick(window_.get(), Qt::Key_F);
    QVERIFY((view.picture().camera().target_W_m - at_first.target_W_m).norm() < 0.01);
    QVERIFY(std::abs(view.picture().camera().distance_m - at_first.distance_m) < 0.01);
    QVERIFY(view.picture().camera().elevation_rad > 0.1);
  }

  void drags_the_trunk_with_both_feet_on_the_ground() {
    window_->open(kRoot / "robots/koboshi/motions/squat.yaml");
    MotionPanel& motion = window_->motion();
    RobotView& view = window_->view();
    QTRY_VERIFY(place_of("trunk"));
    const auto before = view.picture().posed();
    const auto soles = view.picture().scene().sole_links;
    drag(*place_of("trunk"), {0, 30});
    const auto after = view.picture().posed();
    QVERIFY(after[0].p_WL_m.z() < before[0].p_WL_m.z() - 0.002F);
    for (const int sole : soles) {
      const auto link = static_cast<std::size_t>(sole);
      QVERIFY((after[link].p_WL_m - before[link].p_WL_m).norm() < 1e-4F);
    }
    // The right button turns the view, also from the robot.
    const std::string text = motion.text();
    const double azimuth = view.picture().camera().azimuth_rad;
    const QPoint place = *place_of("trunk");
    QTest::mousePress(&view, Qt::RightButton, {}, place);
    QMouseEvent move(QEvent::MouseMove, QPointF(place) + QPointF(50, 0),
                     view.mapToGlobal(QPointF(place) + QPointF(50, 0)), Qt::NoButton, Qt::RightButton, {});
    QApplication::sendEvent(&view, &move);
    QTest::mouseRelease(&view, Qt::RightButton, {}, place);
    QVERIFY(view.picture().camera().azimuth_rad != azimuth);
    QCOMPARE(motion.text(), text);
  }

  void drags_along_an_axis_of_the_gizmo() {
    window_->open(kRoot / "robots/koboshi/motions/squat.yaml");
    RobotView& view = window_->view();
    QTRY_VERIFY(place_of("left_forearm"));
    QVERIFY(!view.gizmo());
    hover(*place_of("left_forearm"));
    QTRY_VERIFY(view.gizmo());
    QVERIFY(!view.gizmo()->rotates);  // the inverse kinematics of an arm has a position only
    save_picture("gizmo");
    const Gizmo arrows = *view.gizmo();
    const QPoint tip = place_of_point(arrows.p_W_m + 0.9 * arrows.length_m * Eigen::Vector3d::UnitZ());
    hover(tip);
    QCOMPARE(view.gizmo_handle_at(tip), std::optional(Handle{Handle::Kind::kArrow, 2}));
    drag(tip, {0, -15});
    const Eigen::Vector3d moved_m = view.gizmo()->p_W_m - arrows.p_W_m;
    QVERIFY2(moved_m.z() > 0.003, qPrintable(QString::number(moved_m.z())));
  }

  // The ring about z rotates the foot; its angle is counted from x.
  void rotates_a_foot_by_a_ring() {
    window_->open(kRoot / "robots/koboshi/motions/squat.yaml");
    MotionPanel& motion = window_->motion();
    RobotView& view = window_->view();
    // Its result changes the layout of the window.
    QTRY_VERIFY_WITH_TIMEOUT(!motion.editor().is_checking(), test::kPatience_ms);
    QTRY_VERIFY(place_of("left_foot"));
    const std::string text = motion.text();
    const view::Pose before = pose_of("left_foot");
    const view::Pose support = pose_of("right_foot");
    const std::size_t undos = motion.editor().document().history().undo_count();
    hover(*place_of("left_foot"));
    QTRY_VERIFY(view.gizmo() && view.gizmo()->rotates);
    const Gizmo rings = *view.gizmo();
    const auto on_ring = [&](double angle_rad) {
      return place_of_point(rings.p_W_m +
                            rings.ring_m() * Eigen::Vector3d(std::cos(angle_rad), std::sin(angle_rad), 0.0));
    };
    expect_body_between(rings);
    constexpr double kFrom_rad = 0.5;
    constexpr double kTurn_rad = 0.3;
    const QPoint from = on_ring(kFrom_rad);
    hover(from);
    QCOMPARE(view.gizmo_handle_at(from), std::optional(Handle{Handle::Kind::kRing, 2}));
    save_view("rings");
    press_and_move(from, on_ring(kFrom_rad + kTurn_rad));
    const QString told = window_->statusBar()->currentMessage();
    save_picture("ring-dragged");
    QTest::mouseRelease(&view, Qt::LeftButton, {}, on_ring(kFrom_rad + kTurn_rad));
    // Pixels are whole: 1 of 70.
    const Eigen::AngleAxisd turned((pose_of("left_foot").q_WL * before.q_WL.conjugate()).cast<double>());
    QVERIFY2(std::abs(turned.angle() - kTurn_rad) < 0.04, qPrintable(QString::number(turned.angle())));
    QVERIFY(turned.axis().z() > 0.999);
    QVERIFY((view.gizmo()->p_W_m - rings.p_W_m).norm() < 1e-3);
    QVERIFY((pose_of("right_foot").p_WL_m - support.p_WL_m).norm() < 1e-4F);
    QVERIFY2(told.startsWith(QStringLiteral("Rotation by ")) && told.contains(QStringLiteral("° about z")),
             qPrintable(told));
    const double told_deg = told.mid(12).section(u'°', 0, 0).toDouble();
    QVERIFY2(std::abs(told_deg - turned.angle() * 180.0 / std::numbers::pi) < 0.2, qPrintable(told));
    QCOMPARE(motion.editor().document().history().undo_count(), undos + 1);
    motion.findChild<QAction*>(QStringLiteral("undo"))->trigger();
    QCOMPARE(motion.text(), text);
    // It keeps its size on the screen: in the same place, half as near is half as large.
    const double share = rings.length_m / view.picture().camera().distance_m;
    QWheelEvent wheel(QPointF(from), view.mapToGlobal(QPointF(from)), {}, {0, 240}, Qt::NoButton, {},
                      Qt::NoScrollPhase, false);
    QApplication::sendEvent(&view, &wheel);
    QVERIFY(view.gizmo()->length_m < 0.9 * rings.length_m);
    QVERIFY(std::abs(view.gizmo()->length_m / view.picture().camera().distance_m - share) < 1e-12);
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
    const std::vector<view::Tint> tints = view.picture().drawn().tints;
    save_picture("limit");
    QTest::mouseRelease(&view, Qt::LeftButton, {}, far.toPoint());
    QVERIFY2(
        told.contains(QStringLiteral("Out of reach by")) && told.contains(QStringLiteral("At the limit")),
        qPrintable(told));
    QCOMPARE(tints.size(), view.picture().scene().links.size());
    const auto share = [&](const char* name) {
      const auto& links = view.picture().scene().links;
      const auto found = std::ranges::find(links, std::string(name), &view::Link::name);
      return tints[static_cast<std::size_t>(found - links.begin())].share;
    };
    for (const char* name : {"left_thigh", "right_thigh", "left_foot"}) QVERIFY2(share(name) > 0.0F, name);
    for (const char* name : {"trunk", "head", "left_forearm"}) QVERIFY2(share(name) == 0.0F, name);
    QVERIFY(view.picture().drawn().tints.empty());
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

  // Over one foot, the other leg keeps its angles and goes along; a hand moves its arm in any case.
  void moves_the_trunk_over_the_chosen_support() {
    window_->open(kRoot / "robots/koboshi/motions/squat.yaml");
    MotionPanel& motion = window_->motion();
    QTRY_VERIFY(place_of("trunk"));
    const auto moved_m = [](const view::Pose& from, const view::Pose& to) {
      return static_cast<double>((to.p_WL_m - from.p_WL_m).norm());
    };
    const auto check = [&](const char* support, bool keeps_left, bool keeps_right) {
      action(support)->trigger();
      QVERIFY(!action(support)->toolTip().isEmpty());
      const std::vector<double> angles = motion.editable_pose();
      const view::Pose left = pose_of("left_foot");
      const view::Pose right = pose_of("right_foot");
      const view::Pose trunk = pose_of("trunk");
      drag(*place_of("trunk"), {0, 20});
      const double down_m = moved_m(trunk, pose_of("trunk"));
      QVERIFY2(down_m > 0.002, support);
      QCOMPARE(moved_m(left, pose_of("left_foot")) < 1e-4, keeps_left);
      QCOMPARE(moved_m(right, pose_of("right_foot")) < 1e-4, keeps_right);
      for (const char* side : {"left", "right"}) {
        const std::size_t knee = joint((std::string(side) + "_knee").c_str());
        const bool keeps = std::string(side) == "left" ? keeps_left : keeps_right;
        QCOMPARE(motion.editable_pose()[knee] == angles[knee], !keeps);
        // The foot that goes along does so as the trunk does.
        const view::Pose& foot = keeps_left ? right : left;
        const char* name = keeps_left ? "right_foot" : "left_foot";
        if (!keeps) QVERIFY(std::abs(moved_m(foot, pose_of(name)) - down_m) < 1e-3);
      }
      motion.findChild<QAction*>(QStringLiteral("undo"))->trigger();
      QCOMPARE(motion.editable_pose(), angles);
    };
    check("Support: lower foot", true, true);
    check("Support: both feet", true, true);
    check("Support: left foot", true, false);
    check("Support: right foot", false, true);
    // With the left foot lifted, the right one is the lower one.
    action("Support: lower foot")->trigger();
    drag(*place_of("left_foot"), {0, -30});
    check("Support: lower foot", false, true);
    const view::Pose left = pose_of("left_foot");
    const view::Pose right = pose_of("right_foot");
    drag(*place_of("left_forearm"), {20, -30});
    QVERIFY(moved_m(left, pose_of("left_foot")) < 1e-4 && moved_m(right, pose_of("right_foot")) < 1e-4);
  }

  void drags_the_ghost_of_a_run() {
    open_with_ghost();
    MotionPanel& motion = window_->motion();
    RobotView& view = window_->view();
    QTRY_VERIFY(place_of("left_forearm"));
    const std::string text = motion.text();
    const std::vector<double> pose = motion.editable_pose();
    const std::vector<view::Pose> robot = view.picture().drawn().links;
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
    for (std::size_t i = 0; i < robot.size(); ++i)
      QCOMPARE(view.picture().drawn().links[i].p_WL_m, robot[i].p_WL_m);
    QVERIFY(window_->run().recording().pushes.empty());
    save_picture("drag-ghost");
  }
};

static const koboshi::test::AddQtTest<PoseDragTest> kPoseDragTest;

}  // namespace koboshi::studio

#include "pose_drag_test.moc"
