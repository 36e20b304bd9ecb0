#include "studio/model/model_panel.h"

#include <QAction>
#include <QApplication>
#include <QCheckBox>
#include <QLineEdit>
#include <QPushButton>
#include <QSignalSpy>
#include <QTemporaryDir>
#include <QTest>
#include <QTreeWidgetItemIterator>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <random>
#include <sstream>
#include <string>

#include "sim_board/description/load.h"
#include "studio/model/body_tree.h"
#include "studio/model/field_view.h"

namespace koboshi::studio {
namespace {

namespace fs = std::filesystem;

const fs::path kFolder = KOBOSHI_SOURCE_DIR "/robots/koboshi";

std::string text_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

// The text with the first place after `after` changed.
std::string with(std::string text, const std::string& after, const std::string& before,
                 const std::string& replacement) {
  const std::size_t start = text.find(after);
  const std::size_t at = start == std::string::npos ? start : text.find(before, start);
  if (at == std::string::npos) qFatal("no such text");
  return text.replace(at, before.size(), replacement);
}

}  // namespace

class ModelPanelTest final : public QObject {
  Q_OBJECT

 private:
  std::unique_ptr<QTemporaryDir> folder_;
  fs::path file_;
  const std::string first_ = text_of(kFolder / "robot.sdf");
  std::unique_ptr<ModelPanel> panel_;

  // Types a value into the field of the chosen element, as a user does.
  void type(const QString& element, const QString& path, const QString& value) {
    panel_->choose(element);
    FieldView& fields = panel_->fields();
    const QModelIndex index = fields.choose(path);
    QVERIFY2(index.isValid(), qPrintable(path));
    QSignalSpy edited(&fields, &FieldView::edited);
    fields.edit(index);
    auto* editor = qobject_cast<QLineEdit*>(QApplication::focusWidget());
    QVERIFY2(editor != nullptr, "no editor");
    editor->selectAll();
    QTest::keyClicks(editor, value);
    QTest::keyClick(editor, Qt::Key_Return);
    QTRY_COMPARE(edited.size(), 1);
  }
  QString shown(const QString& element, const QString& path) {
    panel_->choose(element);
    return panel_->fields().choose(path).data().toString();
  }
  const std::string& text() { return panel_->document()->text(); }

 private Q_SLOTS:
  void init() {
    folder_ = std::make_unique<QTemporaryDir>();
    file_ = fs::path(folder_->path().toStdString()) / "robot.sdf";
    fs::create_directory_symlink(kFolder / "meshes", file_.parent_path() / "meshes");
    std::ofstream(file_, std::ios::binary) << first_;
    panel_ = std::make_unique<ModelPanel>();
    QVERIFY(!panel_->open(file_));
    panel_->resize(460, 700);
    panel_->show();
    panel_->activateWindow();
    QVERIFY(QTest::qWaitForWindowActive(panel_.get()));
  }
  void cleanup() { panel_.reset(); }

  void shows_bodies_joints_and_their_values_in_units_of_people() {
    QStringList names;
    for (QTreeWidgetItemIterator item(&panel_->bodies()); *item != nullptr; ++item)
      names << (*item)->text(BodyTree::kBody) << (*item)->text(BodyTree::kJoint);
    for (const char* name : {"trunk", "left_shank", "left_knee", "head", "head_tilt", "battery", "krs_2552"})
      QVERIFY2(names.contains(QLatin1String(name)), name);
    QCOMPARE(shown(QStringLiteral("left_knee"), QStringLiteral("left_knee.upper")),
             QStringLiteral("150 deg"));
    QCOMPARE(shown(QStringLiteral("left_shank"), QStringLiteral("left_shank.mass")), QStringLiteral("50 g"));
    const QModelIndex mass = panel_->fields().currentIndex();
    QCOMPARE(mass.siblingAtColumn(FieldView::kUnit).data().toString(), QStringLiteral("g"));
    const QString tip = mass.data(Qt::ToolTipRole).toString();
    for (const char* part :
         {"mass of the link", "left_shank.mass", "0.05 kg", "from 1e-06 to 1000", "SDF 1.9"})
      QVERIFY2(tip.contains(QLatin1String(part)), qPrintable(tip));
    QCOMPARE(shown(QStringLiteral("left_knee"), QStringLiteral("left_knee.offset_rad")),
             QStringLiteral("0 deg"));
  }

  void changes_mass_axis_zoom_and_friction_and_saves_these_bytes() {
    type(QStringLiteral("left_shank"), QStringLiteral("left_shank.mass"), QStringLiteral("61.5 g"));
    type(QStringLiteral("left_knee"), QStringLiteral("left_knee.xyz"), QStringLiteral("0 0.99996 0.0087265"));
    type(QStringLiteral("head"), QStringLiteral("head.helmet.scale"), QStringLiteral("0.001 0.001 0.0012"));
    type(QStringLiteral("left_foot"), QStringLiteral("left_foot.mu"), QStringLiteral("0.6"));
    QVERIFY2(panel_->message().isEmpty(), qPrintable(panel_->message()));
    std::string wanted = with(first_, "<link name=\"left_shank\"", "<mass>0.05<", "<mass>0.0615<");
    wanted = with(wanted, "<joint name=\"left_knee\"", "0 1 0", "0 0.99996 0.0087265");
    wanted = with(wanted, "meshes/helmet.stl", "0.001 0.001 0.001", "0.001 0.001 0.0012");
    wanted = with(wanted, "<link name=\"left_foot\"", "<mu>0.8<", "<mu>0.6<");
    QVERIFY(text() == wanted);
    QVERIFY(panel_->modified());
    QVERIFY(panel_->undo());
    QVERIFY(panel_->undo());
    QCOMPARE(shown(QStringLiteral("left_foot"), QStringLiteral("left_foot.mu")), QStringLiteral("0.8"));
    QVERIFY(panel_->redo());
    QVERIFY(panel_->redo());
    QVERIFY(!panel_->redo());
    QVERIFY(panel_->save());
    QVERIFY(text_of(file_) == wanted);
    QVERIFY(!panel_->modified());
    for (int i = 0; i < 4; ++i) QVERIFY(panel_->undo());
    QVERIFY(!panel_->undo());
    QVERIFY(text() == first_);
    QVERIFY(panel_->modified());
  }

  void mirrors_to_the_other_side() {
    panel_->set_both_sides(true);
    type(QStringLiteral("left_hip_roll"), QStringLiteral("left_hip_roll.lower"), QStringLiteral("-30 deg"));
    QCOMPARE(shown(QStringLiteral("right_hip_roll"), QStringLiteral("right_hip_roll.upper")),
             QStringLiteral("30 deg"));
    type(QStringLiteral("trunk"), QStringLiteral("trunk.mass"),
         QStringLiteral("361 g"));  // has no other side
    QCOMPARE(shown(QStringLiteral("trunk"), QStringLiteral("trunk.mass")), QStringLiteral("361 g"));
    QVERIFY(panel_->undo());
    QVERIFY(panel_->undo());
    QVERIFY(text() == first_);
  }

  void says_why_a_value_is_refused_and_keeps_the_old_one() {
    for (const char* value : {"-1", "heavy", "5 mm", "1e9"}) {
      type(QStringLiteral("left_shank"), QStringLiteral("left_shank.mass"), QLatin1String(value));
      QVERIFY2(panel_->message().contains(QLatin1String("expected a number from 1e-06 to 1000 in kg")),
               qPrintable(panel_->message()));
      QCOMPARE(shown(QStringLiteral("left_shank"), QStringLiteral("left_shank.mass")),
               QStringLiteral("50 g"));
    }
    // Without a unit as on the command line: in that of the file.
    type(QStringLiteral("left_shank"), QStringLiteral("left_shank.mass"), QStringLiteral("45"));
    QVERIFY2(panel_->message().contains(QLatin1String("did you mean 45 g?")), qPrintable(panel_->message()));
    QVERIFY(text() == first_);
    type(QStringLiteral("left_knee"), QStringLiteral("left_knee.xyz"), QStringLiteral("0 1 1"));
    QVERIFY2(panel_->message().contains(QLatin1String("unit vector")), qPrintable(panel_->message()));
    QVERIFY(text() == first_);
    type(QStringLiteral("left_shank"), QStringLiteral("left_shank.mass"), QStringLiteral("0.06 kg"));
    QVERIFY(panel_->message().isEmpty());
    QCOMPARE(shown(QStringLiteral("left_shank"), QStringLiteral("left_shank.mass")), QStringLiteral("60 g"));
  }

  void shows_findings_beside_the_fields() {
    QVERIFY(panel_->set(QStringLiteral("left_thigh.mass"), QStringLiteral("70 g")));
    panel_->choose(QStringLiteral("right_thigh"));
    const auto has_finding = [&](const char* part) {
      const QAbstractItemModel& rows = *panel_->fields().model();
      for (int group = 0; group < rows.rowCount(); ++group)
        for (int row = 0; row < rows.rowCount(rows.index(group, 0)); ++row)
          if (rows.index(row, 0, rows.index(group, 0)).data().toString().contains(QLatin1String(part)))
            return true;
      return false;
    };
    panel_->choose(QStringLiteral("left_thigh"));
    const bool left = has_finding("R003");
    panel_->choose(QStringLiteral("right_thigh"));
    QVERIFY(left || has_finding("R003"));
    QVERIFY(panel_->undo());
    QVERIFY(!has_finding("R003"));
  }

  void says_whether_the_simulation_has_the_model() {
    auto* again = panel_->findChild<QPushButton*>(QStringLiteral("start_again_model"));
    QSignalSpy asked(panel_.get(), &ModelPanel::start_again_requested);
    QVERIFY(!again->isEnabled());
    panel_->set_running(first_);
    QVERIFY(panel_->set(QStringLiteral("head.helmet.zoom"), QStringLiteral("0.001 0.001 0.002")));
    QVERIFY(!again->isEnabled());
    QVERIFY2(panel_->effect().contains(QLatin1String("at once")), qPrintable(panel_->effect()));
    QVERIFY(panel_->set(QStringLiteral("left_foot.friction"), QStringLiteral("0.5")));
    QVERIFY2(panel_->effect().contains(QLatin1String("Start again")), qPrintable(panel_->effect()));
    QTest::mouseClick(again, Qt::LeftButton);
    QCOMPARE(asked.size(), 1);
    panel_->set_running(text());
    QVERIFY(!again->isEnabled());
  }

  void choosing_in_the_tree_shows_the_values() {
    QSignalSpy chosen(panel_.get(), &ModelPanel::chosen_changed);
    BodyTree& tree = panel_->bodies();
    for (QTreeWidgetItemIterator item(&tree); *item != nullptr; ++item)
      if ((*item)->text(BodyTree::kJoint) == QLatin1String("left_knee")) {
        tree.scrollToItem(*item);
        const QRect place = tree.visualRect(tree.indexFromItem(*item, BodyTree::kJoint));
        QTest::mouseClick(tree.viewport(), Qt::LeftButton, {}, place.center());
      }
    QVERIFY(!chosen.isEmpty());
    QCOMPARE(chosen.back().front().toString(), QStringLiteral("left_knee"));
    QVERIFY(panel_->fields().choose(QStringLiteral("left_knee.upper")).isValid());
  }

  void returns_to_the_first_byte_after_random_edits() {
    std::mt19937 random(25);
    const QStringList paths{QStringLiteral("left_shank.mass"),    QStringLiteral("trunk.com"),
                            QStringLiteral("left_knee.upper"),    QStringLiteral("head.helmet.zoom"),
                            QStringLiteral("left_foot.friction"), QStringLiteral("left_foot.size"),
                            QStringLiteral("krs_2552.supply_V"),  QStringLiteral("trunk.gyro.bias")};
    for (int i = 0; i < 12; ++i) {
      const auto kind = random() % 5;
      if (kind == 0) {
        panel_->undo();
      } else if (kind == 1) {
        panel_->redo();
      } else {
        const QString& path = paths[static_cast<int>(random() % static_cast<unsigned>(paths.size()))];
        const auto field = sim_board::find_field(panel_->document()->xml(), path.toStdString());
        QStringList numbers;
        for (std::size_t n = 0; n < field.numbers(); ++n)
          numbers << QString::number(0.001 * static_cast<double>(random() % 2000));
        panel_->set_both_sides(random() % 2 == 0);
        panel_->set(path, numbers.join(QLatin1Char(' ')));
      }
    }
    while (panel_->undo()) {
    }
    QVERIFY(text() == first_);
    QVERIFY(!panel_->modified());
  }
};

}  // namespace koboshi::studio

QTEST_MAIN(koboshi::studio::ModelPanelTest)
#include "model_panel_test.moc"
