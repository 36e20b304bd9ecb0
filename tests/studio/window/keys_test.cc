// Real keys: xdotool presses them, and a window manager and the X server bring them to the window.

#include <QAbstractButton>
#include <QAbstractItemView>
#include <QCheckBox>
#include <QClipboard>
#include <QComboBox>
#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QGuiApplication>
#include <QLabel>
#include <QLineEdit>
#include <QMessageBox>
#include <QPlainTextEdit>
#include <QSlider>
#include <QTabBar>
#include <QTableView>
#include <QTemporaryDir>
#include <QToolButton>
#include <QTreeView>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "studio/controls/transport_bar.h"
#include "studio/model/field_view.h"
#include "studio/model/model_panel.h"
#include "studio/motion_editor/joint_panel.h"
#include "studio/motion_editor/motion_panel.h"
#include "studio/panels/log_panel.h"
#include "studio/plot/plot_widget.h"
#include "studio/tuning/parameter_panel.h"
#include "studio/tuning/parameter_row.h"
#include "studio/widgets/message_bar.h"
#include "studio/window/documents.h"
#include "tests/studio/window/keyboard_fixture.h"

namespace koboshi::studio {

namespace fs = std::filesystem;

using test::kPatience_ms;
using test::kRoot;

class KeysTest final : public KeyboardFixture {
  Q_OBJECT

 private:
  QTemporaryDir folder_;
  fs::path motion_file_;

  static std::string text_of(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

 private Q_SLOTS:
  // All tests share a window with a motion and a run.
  void initTestCase() {
    show_window();
    motion_file_ = fs::path(folder_.path().toStdString()) / "squat.yaml";
    fs::copy_file(kRoot / "robots/koboshi/motions/squat.yaml", motion_file_);
    window_->open(motion_file_);
    open_scenario("squat.yaml");
    // The list of signals is hidden at first.
    const auto buttons = window_->findChildren<QToolButton*>();
    const auto signal_list = std::ranges::find_if(buttons, [](const QToolButton* one) {
      return one->toolTip().contains(QStringLiteral("list of signals"));
    });
    QVERIFY(signal_list != buttons.end());
    (*signal_list)->setChecked(true);
  }
  void init() {
    window_->activateWindow();
    QVERIFY(QTest::qWaitForWindowActive(window_.get()));
  }
  void cleanupTestCase() { window_.reset(); }

  void keys_act_on_the_motion_wherever_the_keyboard_is() {
    MotionPanel& motion = window_->motion();
    const std::string before = motion.text();
    for (const Place& place : places()) {
      QVERIFY2(place.widget != nullptr, place.name);
      motion.insert_pose(motion.editor().rows().rows.front().angles_rad, "mine");
      const std::string after = motion.text();
      QVERIFY(after != before);
      QVERIFY2(focus(place), place.name);
      QCOMPARE(window_->documents().active(), Documents::kMotion);
      QVERIFY(press("ctrl+z"));
      QVERIFY2(motion.text() == before, place.name);
      QVERIFY(press("ctrl+y"));
      QVERIFY2(motion.text() == after, place.name);
      QVERIFY(press("ctrl+s"));
      QVERIFY2(text_of(motion_file_) == after, place.name);
      QVERIFY(!motion.modified());
      QVERIFY(press({QStringLiteral("ctrl+z"), QStringLiteral("ctrl+shift+z"), QStringLiteral("ctrl+z")}));
      QVERIFY2(motion.text() == before, place.name);
      QVERIFY2(window_->windowTitle().startsWith(QStringLiteral("squat.yaml*")), place.name);
    }
  }

  // A hand that is dragged in the view with the mouse: its edit is taken back, made again and saved.
  void keys_act_on_a_pose_dragged_in_the_view() {
    MotionPanel& motion = window_->motion();
    motion.show_row(0);  // a pose; the next row waits
    raise("events");
    const std::string before = motion.text();
    window_->view().look_at_robot();
    std::optional<QPoint> hand;
    QTRY_VERIFY_WITH_TIMEOUT((hand = place_of("left_forearm")), kPatience_ms);
    const QPoint from = window_->view().mapToGlobal(*hand);
    const auto at = [](const QPoint& place) {
      return QStringList{QStringLiteral("mousemove"), QStringLiteral("--sync"), QString::number(place.x()),
                         QString::number(place.y())};
    };
    QVERIFY(xdotool(at(from) + QStringList{QStringLiteral("mousedown"), QStringLiteral("1")}));
    QVERIFY(xdotool(at(from + QPoint(10, -10)) + at(from + QPoint(25, -25)) +
                    QStringList{QStringLiteral("mouseup"), QStringLiteral("1")}));
    QTRY_VERIFY(motion.text() != before);
    QTest::qWait(50);
    const std::string after = motion.text();
    QVERIFY(press("ctrl+s"));
    QVERIFY(text_of(motion_file_) == after);
    QVERIFY(press("ctrl+z"));
    QVERIFY(motion.text() == before);
    QVERIFY(press("ctrl+y"));
    QVERIFY(motion.text() == after);
    QVERIFY(press({QStringLiteral("ctrl+z"), QStringLiteral("ctrl+s")}));
    QVERIFY(text_of(motion_file_) == before);
  }

  // The robot and its parameters are active while their panels have the keyboard.
  void the_panel_with_the_keyboard_has_the_active_document() {
    ModelPanel& model = window_->model();
    raise("model");
    QVERIFY(model.set(QStringLiteral("left_shank.mass"), QStringLiteral("45 g")));
    QCOMPARE(window_->documents().active(), Documents::kRobot);
    auto* label = window_->findChild<QLabel*>(QStringLiteral("active_document"));
    QCOMPARE(label->text(), QStringLiteral("Robot: robot.sdf*"));
    const std::string motion = window_->motion().text();
    QVERIFY(focus({"view", "", &window_->view()}));
    QVERIFY(press("ctrl+z"));
    QVERIFY(!model.modified());
    QVERIFY(press("Delete"));  // it would delete a step of the motion, which is not the active document
    QVERIFY(window_->motion().text() == motion);

    auto* parameters = window_->findChild<ParameterPanel*>();
    ParameterEditor& editor = parameters->editor();
    editor.show(ParameterEditor::kRobot);
    const double value = *editor.document()->value(0);
    QVERIFY(editor.set(0, value * 1.01) || editor.set(0, value * 0.9));
    QVERIFY(editor.is_modified());
    QCOMPARE(window_->documents().active(), Documents::kParameters);
    QVERIFY(focus({"search for parameters", "parameters", in_dock<QLineEdit>("parameters")}));
    QVERIFY(press("ctrl+z"));
    QVERIFY(!editor.is_modified());
    QVERIFY(press("ctrl+y"));
    QVERIFY(editor.is_modified());
    QVERIFY(press("ctrl+z"));
    QVERIFY(window_->motion().text() == motion);
    QVERIFY(focus({"steps", "motion", window_->motion().findChild<QTableView*>(QStringLiteral("steps"))}));
    QCOMPARE(window_->documents().active(), Documents::kMotion);
    QVERIFY(in_dock<QWidget>("motion") != nullptr);
    QVERIFY(window_->findChild<QDockWidget*>(QStringLiteral("motion"))->windowTitle().contains(u'\u25B8'));
  }

  // A field has the keys of its own text; Escape empties a search and gives the keyboard back.
  void escape_leaves_every_search_field() {
    const std::string motion = window_->motion().text();
    RunController& run = window_->run();
    int fields = 0;
    for (QLineEdit* field : window_->findChildren<QLineEdit*>()) {
      if (!field->isClearButtonEnabled()) continue;
      for (QDockWidget* dock : window_->findChildren<QDockWidget*>())
        if (dock->isAncestorOf(field)) raise(dock->objectName().toLatin1().constData());
      if (!field->isVisible()) continue;
      ++fields;
      const QByteArray name = field->placeholderText().toUtf8();
      window_->view().setFocus();
      QVERIFY2(click(*field, QPoint(20, field->height() / 2)), name.constData());
      QTRY_VERIFY2(field->hasFocus(), name.constData());
      QVERIFY(press({QStringLiteral("k"), QStringLiteral("n"), QStringLiteral("1"), QStringLiteral("space"),
                     QStringLiteral("e"), QStringLiteral("ctrl+z")}));
      QVERIFY2(field->text() != QStringLiteral("kn1 e"), name.constData());  // the text's own undo
      QVERIFY(window_->motion().text() == motion);
      QVERIFY(!run.playing());
      QVERIFY(press("Escape"));
      QVERIFY2(field->text().isEmpty(), name.constData());
      QVERIFY2(!field->hasFocus(), name.constData());
      QVERIFY(press("space"));
      QTRY_VERIFY2(run.playing(), name.constData());
      QVERIFY(press("space"));
      QTRY_VERIFY2(!run.playing(), name.constData());
    }
    QVERIFY2(fields >= 5, qPrintable(QString::number(fields)));
  }

  // Keys that a table, a number box or a button would have otherwise.
  void keys_of_widgets_and_of_the_window_do_not_disturb_each_other() {
    RunController& run = window_->run();
    auto* box = window_->motion().findChild<JointPanel*>()->spin_box(0);
    window_->motion().show_row(0);  // a pose; the next row waits
    QVERIFY(focus({"joint's number", "motion", box}));
    QVERIFY(press("space"));
    QTRY_VERIFY(run.playing());
    QVERIFY(press("space"));
    QTRY_VERIFY(!run.playing());
    // A digit goes into the cell that has the keyboard, and does not turn the camera.
    auto* steps = window_->motion().findChild<QTableView*>(QStringLiteral("steps"));
    QVERIFY(focus({"steps", "motion", steps}));
    const QModelIndex time = steps->model()->index(1, 2);
    steps->setCurrentIndex(time);
    const Eigen::Vector2d camera(window_->view().picture().camera().azimuth_rad,
                                 window_->view().picture().camera().elevation_rad);
    QVERIFY(press({QStringLiteral("2"), QStringLiteral("Return")}));
    QTRY_COMPARE(time.data().toString(), QStringLiteral("2"));
    QVERIFY(Eigen::Vector2d(window_->view().picture().camera().azimuth_rad,
                            window_->view().picture().camera().elevation_rad) == camera);
    QVERIFY(press("ctrl+z"));
    QVERIFY(time.data().toString() != QStringLiteral("2"));
    // Saving includes the number that is being typed.
    window_->motion().show_row(0);
    box->setFocus();
    box->selectAll();
    const double before_deg = box->value();
    QVERIFY(press({QStringLiteral("5"), QStringLiteral("ctrl+s")}));
    QVERIFY(box->value() != before_deg);
    QVERIFY(text_of(motion_file_) == window_->motion().text());
    QVERIFY(press({QStringLiteral("ctrl+z"), QStringLiteral("ctrl+s")}));
    QCOMPARE(box->value(), before_deg);
    // Enter presses a button, because Space starts the run.
    auto* live = in_dock<QCheckBox>("objects");
    QVERIFY(focus({"check box", "objects", live}));
    const bool was_checked = live->isChecked();
    QVERIFY(press("Return"));
    QTRY_VERIFY(live->isChecked() != was_checked);
    live->setChecked(was_checked);
    // The log can be copied.
    window_->messages().show_message(QStringLiteral("to be copied"), MessageKind::kWarning);
    QVERIFY(focus({"log", "messages", in_dock<QPlainTextEdit>("messages", "log")}));
    QVERIFY(press({QStringLiteral("ctrl+a"), QStringLiteral("ctrl+c")}));
    QVERIFY(QGuiApplication::clipboard()->text().contains(QStringLiteral("Warning to be copied")));
    window_->messages().hide();
  }

  // The key of a panel that another one hides brings it to the front, with the keyboard.
  void a_key_brings_a_panel_to_the_front() {
    raise("events");
    auto* motion = window_->findChild<QDockWidget*>(QStringLiteral("motion"));
    QVERIFY(motion->visibleRegion().isEmpty());
    QVERIFY(press("alt+8"));
    QTRY_VERIFY(!motion->visibleRegion().isEmpty());
    QVERIFY(motion->isAncestorOf(QApplication::focusWidget()));
    QVERIFY(press("alt+8"));
    QTRY_VERIFY(motion->isHidden());
    QVERIFY(press("alt+8"));
    QTRY_VERIFY(!motion->visibleRegion().isEmpty());
  }

  // Step 1 of the tutorial: the tab, and Ctrl+N. Unsaved changes are not lost.
  void begins_a_motion_on_its_tab() {
    window_->view().setFocus();
    raise("events");
    QTabBar* tabs = nullptr;
    int tab = -1;
    for (auto* bar : window_->findChildren<QTabBar*>())
      for (int i = 0; i < bar->count(); ++i)
        if (bar->tabText(i).contains(QStringLiteral("Motion")) && bar->isVisible()) {
          tabs = bar;
          tab = i;
        }
    QVERIFY(tabs != nullptr);
    QVERIFY(click(*tabs, tabs->tabRect(tab).center()));
    QTRY_VERIFY(window_->motion().isVisible());
    window_->motion().insert_pose(window_->motion().editor().rows().rows.front().angles_rad, "mine");
    const auto question = [this] { return window_->findChild<QMessageBox*>(QStringLiteral("unsaved")); };
    const auto is_shown = [&] { return question() != nullptr && question()->isActiveWindow(); };
    QVERIFY(press("ctrl+n"));
    QTRY_VERIFY(is_shown());
    QVERIFY(question()->informativeText().contains(QStringLiteral("Motion: squat.yaml")));
    QVERIFY(press("Escape"));
    QTRY_VERIFY(question() == nullptr);
    QCOMPARE(window_->motion().file(), motion_file_);
    QVERIFY(window_->motion().modified());
    QVERIFY(press("ctrl+n"));
    QTRY_VERIFY(is_shown());
    QVERIFY(press("alt+d"));
    QTRY_VERIFY(window_->motion().file().empty());
    QVERIFY(window_->windowTitle().startsWith(QStringLiteral("untitled*")));
    QVERIFY(press("Insert"));
    QCOMPARE(window_->motion().editor().rows().rows.size(), 2U);
    window_->open(motion_file_);
    QTRY_VERIFY(is_shown());
    QVERIFY(press("alt+d"));
    QTRY_COMPARE(window_->motion().file(), motion_file_);
  }

  // Last: it closes the window.
  void asks_before_it_closes() {
    const auto question = [this] { return window_->findChild<QMessageBox*>(QStringLiteral("unsaved")); };
    const auto is_shown = [&] { return question() != nullptr && question()->isActiveWindow(); };
    MotionPanel& motion = window_->motion();
    motion.insert_pose(motion.editor().rows().rows.front().angles_rad, "mine");
    QVERIFY(window_->model().set(QStringLiteral("left_shank.mass"), QStringLiteral("45 g")));
    QVERIFY(press("ctrl+q"));
    QTRY_VERIFY(is_shown());
    QCOMPARE(question()->informativeText(), QStringLiteral("Motion: squat.yaml\nRobot: robot.sdf"));
    save_picture("closing");
    QVERIFY(press({QStringLiteral("ctrl+q"), QStringLiteral("ctrl+q")}));
    QVERIFY(window_->isVisible());
    QVERIFY(press("Escape"));
    QTRY_VERIFY(question() == nullptr);
    QVERIFY(window_->isVisible());
    QVERIFY(motion.modified() && window_->model().modified());
    QVERIFY(window_->model().undo());
    QVERIFY(press("ctrl+q"));
    QTRY_VERIFY(is_shown());
    const std::string text = motion.text();
    QVERIFY(press("Return"));
    QTRY_VERIFY(!window_->isVisible());
    QVERIFY(text_of(motion_file_) == text);
  }
};

}  // namespace koboshi::studio

int main(int argc, char** argv) {
  return koboshi::studio::test::run_window_test<koboshi::studio::KeysTest>(argc, argv);
}

#include "keys_test.moc"
