// The window's texts: translations, shortcuts, tooltips, colours and resolution.

#include <QAbstractItemModel>
#include <QAbstractItemView>
#include <QAbstractScrollArea>
#include <QAbstractSpinBox>
#include <QComboBox>
#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QGroupBox>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QMenu>
#include <QProcess>
#include <QRegularExpression>
#include <QShortcut>
#include <QTabBar>
#include <QTableView>
#include <QTemporaryDir>
#include <QToolButton>
#include <QTranslator>
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "studio/motion_editor/motion_panel.h"
#include "studio/plot/plot_widget.h"
#include "studio/widgets/theme.h"
#include "tests/studio/window/painted_text.h"
#include "tests/studio/window/pseudo_locale.h"
#include "tests/studio/window/window_fixture.h"

namespace koboshi::studio {

using test::kRoot;

class TextTest final : public QObject {
  Q_OBJECT

 private:
  std::unique_ptr<MainWindow> window_;
  QTemporaryDir folder_;
  std::unique_ptr<QTranslator> locale_;

  // Joins the missing texts in one line, without doubles.
  static QString join(QStringList missing) {
    missing.removeDuplicates();
    return missing.join(QStringLiteral(" | "));
  }
  bool show_translated() {
    window_.reset();
    if (!locale_) locale_ = translate_studio(folder_.path());
    if (!locale_) return false;
    QApplication::installTranslator(locale_.get());
    window_ = test::make_window();
    return window_ != nullptr;
  }
  void show_every_dock(const std::function<void(QDockWidget&)>& look) {
    for (QDockWidget* dock : window_->findChildren<QDockWidget*>()) {
      dock->show();
      dock->raise();
      QApplication::processEvents();
      QTest::qWait(30);
      look(*dock);
    }
  }
  // The texts that widgets of the studio paint; every_text_is_translated() checks widgets of Qt.
  QStringList painted_by_widgets() {
    QStringList texts;
    show_every_dock([&](QDockWidget& dock) {
      for (QWidget* one : dock.findChildren<QWidget*>()) {
        const bool is_own = QByteArray(one->metaObject()->className()).startsWith("koboshi::studio::");
        if (!is_own || !one->isVisible()) continue;
        if (qobject_cast<QAbstractItemView*>(one) != nullptr) continue;
        texts += test::painted_texts(*one);
        if (const auto* area = qobject_cast<const QAbstractScrollArea*>(one))
          texts += test::painted_texts(*area->viewport());
      }
    });
    return texts;
  }
  // Names of files and words of the firmware, which stay as they are.
  QStringList words_of_files() {
    QStringList words;
    const auto add = [&](const std::string& word) { words << QString::fromStdString(word); };
    for (const view::Signal& signal : window_->run().recording().signals) {
      add(signal.name);
      for (const auto& [value, name] : signal.names) add(name);
    }
    for (const view::Event& event : window_->run().recording().events) add(event.text);
    for (const MotionRow& row : window_->motion().editor().rows().rows) {
      add(row.text);
      add(row.pose);
      add(row.label);
    }
    return words;
  }

 private Q_SLOTS:
  void init() {
    window_ = test::make_window();
    QVERIFY(window_);
  }
  void cleanup() {
    if (locale_) QApplication::removeTranslator(locale_.get());
    window_.reset();
    apply_theme(Theme::kLight);
  }

  void every_action_has_a_shortcut_of_its_own() {
    QMap<QString, QString> shortcuts;
    QStringList without;
    for (const QAction* one : window_->all_actions()) {
      QVERIFY(!one->text().isEmpty());
      if (one->shortcuts().isEmpty()) without << one->text();
      for (const QKeySequence& keys : one->shortcuts()) {
        const QString text = keys.toString();
        QVERIFY2(!text.isEmpty(), qPrintable(one->text()));
        QVERIFY2(!shortcuts.contains(text), qPrintable(text + QStringLiteral(": ") + one->text() +
                                                       QStringLiteral(" and ") + shortcuts.value(text)));
        shortcuts.insert(text, one->text());
      }
    }
    QVERIFY2(without.isEmpty(), qPrintable(join(without)));
    QVERIFY(shortcuts.size() > 60);
  }

  // Qt calls neither of two shortcuts with the same keys, without a word.
  void no_keys_are_ambiguous() {
    QMap<QString, QString> owners;
    const auto add = [&](const QKeySequence& keys, const QString& owner) {
      const QString text = keys.toString();
      if (text.isEmpty()) return;
      QVERIFY2(!owners.contains(text), qPrintable(text + QStringLiteral(": ") + owner +
                                                  QStringLiteral(" and ") + owners.value(text)));
      owners.insert(text, owner);
    };
    for (const QAction* one : window_->findChildren<QAction*>())
      if (qobject_cast<QLineEdit*>(one->parent()) == nullptr)
        for (const QKeySequence& keys : one->shortcuts()) add(keys, one->text());
    for (const QShortcut* one : window_->findChildren<QShortcut*>())
      add(one->key(), QLatin1String(one->parent()->metaObject()->className()));
    for (const char* keys : {"Ctrl+Z", "Ctrl+Y", "Ctrl+Shift+Z", "Ctrl+S", "Ctrl+N", "Ctrl+Q"})
      QVERIFY2(owners.contains(QLatin1String(keys)), keys);
  }

  // Every action of the window is in a menu, and so in the command search.
  void every_action_is_in_a_menu() {
    QStringList missing;
    const QList<QAction*> in_menus = window_->all_actions();
    for (const QAction* one : window_->findChildren<QAction*>()) {
      const bool is_command = !one->isSeparator() && one->menu() == nullptr && !one->text().isEmpty() &&
                              !one->shortcut().isEmpty() &&
                              qobject_cast<QLineEdit*>(one->parent()) == nullptr;
      if (is_command && !in_menus.contains(const_cast<QAction*>(one))) missing << one->text();
    }
    QVERIFY2(missing.isEmpty(), qPrintable(join(missing)));
  }

  // Walks all widgets, actions and tooltips.
  void every_text_is_translated() {
    QVERIFY(show_translated());
    QStringList missing;
    const auto require = [&](const QString& text, const QObject* of) {
      static const QRegularExpression letters(QStringLiteral("[A-Za-z]{3,}"));
      if (letters.match(text).hasMatch() && !text.contains(QChar(u'«')))
        missing << QLatin1String(of->metaObject()->className()) + u' ' + text;
    };
    for (const QAction* one : window_->all_actions()) {
      require(one->text(), one);
      require(one->toolTip(), one);
      require(one->statusTip(), one);
    }
    for (const QMenu* menu : window_->findChildren<QMenu*>()) require(menu->title(), menu);
    for (const QWidget* one : window_->findChildren<QWidget*>()) {
      if (one->property("verbatim").toBool()) continue;  // words of files and of the firmware's tables
      // Qt has translations of its own for the buttons that it makes.
      if (one->inherits("QDockWidgetTitleButton") || one->parentWidget()->inherits("QTabBar")) continue;
      require(one->toolTip(), one);
      require(one->statusTip(), one);
      require(one->accessibleName(), one);
      if (const auto* label = qobject_cast<const QLabel*>(one)) require(label->text(), one);
      if (const auto* button = qobject_cast<const QAbstractButton*>(one)) require(button->text(), one);
      if (const auto* group = qobject_cast<const QGroupBox*>(one)) require(group->title(), one);
      if (const auto* dock = qobject_cast<const QDockWidget*>(one)) require(dock->windowTitle(), one);
      if (const auto* edit = qobject_cast<const QLineEdit*>(one)) require(edit->placeholderText(), one);
      if (const auto* box = qobject_cast<const QAbstractSpinBox*>(one)) require(box->specialValueText(), one);
      if (const auto* bar = qobject_cast<const QTabBar*>(one))
        for (int i = 0; i < bar->count(); ++i) require(bar->tabText(i), one);
      if (const auto* table = qobject_cast<const QTableView*>(one);
          table != nullptr && table->model() != nullptr)
        for (int i = 0; i < table->model()->columnCount(); ++i)
          for (const int role : {Qt::DisplayRole, Qt::ToolTipRole})
            require(table->model()->headerData(i, Qt::Horizontal, role).toString(), one);
      // Identifiers of files stay as they are.
      static const QStringList identifiers{QStringLiteral("stepper"), QStringLiteral("fault_kind"),
                                           QStringLiteral("fault_target"), QStringLiteral("push_link"),
                                           QStringLiteral("motions")};
      if (const auto* box = qobject_cast<const QComboBox*>(one);
          box && !identifiers.contains(box->objectName()))
        for (int i = 0; i < box->count(); ++i) require(box->itemText(i), one);
    }
    QVERIFY2(missing.isEmpty(), qPrintable(join(missing)));
  }

  // Walks the texts that widgets paint themselves, in an empty window and in one with a motion and a run.
  void every_painted_text_is_translated() {
    QVERIFY(show_translated());
    QStringList painted = painted_by_widgets();
    window_->open(kRoot / "robots/koboshi/motions/squat.yaml");
    QVERIFY(test::open(*window_, kRoot / "scenarios/walk.yaml"));
    QVERIFY(test::run_to(*window_, 800'000));
    QTRY_VERIFY_WITH_TIMEOUT(!window_->motion().editor().is_checking(), test::kPatience_ms);
    painted += painted_by_widgets();
    TimeView time;
    PlotWidget empty(time, nullptr);
    painted += test::painted_texts(empty);
    painted.removeDuplicates();
    const QStringList words = words_of_files();
    // Also in part: with an ellipsis, or without the part of a signal's name that a plot has in common.
    const auto is_word = [&](QString text) {
      const bool is_cut = text.endsWith(u'…');
      if (is_cut) text.chop(1);
      return std::ranges::any_of(words, [&](const QString& word) {
        return is_cut ? word.startsWith(text) : word == text || word.endsWith(u'_' + text);
      });
    };
    static const QRegularExpression letters(QStringLiteral("[A-Za-z]{3,}"));
    QStringList missing;
    for (const QString& text : std::as_const(painted))
      if (letters.match(text).hasMatch() && !text.contains(u'«') && !is_word(text)) missing << text;
    QVERIFY2(missing.isEmpty(), qPrintable(join(missing)));
    // There is a text of each widget that paints texts: nothing was hidden.
    for (const char* text :
         {"State", "Drop signals", "forward", "A run shows", "margin", "its speed", "evaluation"})
      QVERIFY2(std::ranges::any_of(
                   painted, [&](const QString& one) { return one.startsWith(u'«' + QLatin1String(text)); }),
               text);
  }

  // Texts that are 40 % longer still fit.
  void no_label_is_cut_off() {
    QVERIFY(show_translated());
    QStringList cut;
    show_every_dock([&](QDockWidget& dock) {
      for (const QWidget* one : dock.findChildren<QWidget*>()) {
        if (!one->isVisible()) continue;
        const auto* label = qobject_cast<const QLabel*>(one);
        const auto* button = qobject_cast<const QAbstractButton*>(one);
        const QString text = label ? label->text() : button ? button->text() : QString();
        if (text.isEmpty() || one->parentWidget()->inherits("QTabBar")) continue;
        const bool wraps = label != nullptr && label->wordWrap();
        const bool fits = wraps ? one->height() + 1 >= label->heightForWidth(one->width())
                                : one->width() + 1 >= one->sizeHint().width();
        if (!fits)
          cut << QStringLiteral("%1: %2 (%3 of %4 px)")
                     .arg(dock.objectName(), text)
                     .arg(wraps ? one->height() : one->width())
                     .arg(wraps ? label->heightForWidth(one->width()) : one->sizeHint().width());
      }
    });
    test::save_picture(*window_, "pseudo-locale");
    QVERIFY2(cut.isEmpty(), qPrintable(join(cut)));
  }

  // The tooltip of a number says in which unit it is.
  void tooltips_of_numbers_name_their_units() {
    const QMap<QString, QString> words{
        {QStringLiteral("°"), QStringLiteral("degrees")},   {QStringLiteral("s"), QStringLiteral("seconds")},
        {QStringLiteral("N"), QStringLiteral("newtons")},   {QStringLiteral("m/s"), QStringLiteral("m/s")},
        {QStringLiteral("rad/s"), QStringLiteral("rad/s")}, {QStringLiteral("mm"), QStringLiteral("mm")},
        {QStringLiteral("%"), QStringLiteral("%")}};
    QStringList missing;
    int boxes = 0;
    for (const QDoubleSpinBox* box : window_->findChildren<QDoubleSpinBox*>()) {
      const QString unit = box->suffix().trimmed();
      if (box->toolTip().isEmpty()) {
        missing << (box->objectName().isEmpty() ? box->accessibleName() : box->objectName()) +
                       QStringLiteral(" of ") + QLatin1String(box->parent()->metaObject()->className());
      } else if (!unit.isEmpty() && !box->toolTip().contains(words.value(unit, unit))) {
        missing << box->toolTip() + QStringLiteral(": ") + unit;
      }
      ++boxes;
    }
    QVERIFY(boxes > 10);
    QVERIFY2(missing.isEmpty(), qPrintable(join(missing)));
  }

  // Text can be read on its ground in both themes: a contrast of 4.5 (WCAG 2.1, 1.4.3).
  void themes_can_be_read() {
    const auto luminance = [](const QColor& colour) {
      const auto linear = [](double part) {
        return part <= 0.03928 ? part / 12.92 : std::pow((part + 0.055) / 1.055, 2.4);
      };
      return 0.2126 * linear(colour.redF()) + 0.7152 * linear(colour.greenF()) +
             0.0722 * linear(colour.blueF());
    };
    for (const Theme theme : {Theme::kLight, Theme::kDark}) {
      apply_theme(theme);
      const QPalette palette = QApplication::palette();
      const std::pair<QPalette::ColorRole, QPalette::ColorRole> pairs[] = {
          {QPalette::WindowText, QPalette::Window},
          {QPalette::Text, QPalette::Base},
          {QPalette::Text, QPalette::AlternateBase},
          {QPalette::ButtonText, QPalette::Button},
          {QPalette::ToolTipText, QPalette::ToolTipBase}};
      for (const auto& [text, ground] : pairs) {
        const double a = luminance(palette.color(text));
        const double b = luminance(palette.color(ground));
        const double contrast = (std::max(a, b) + 0.05) / (std::min(a, b) + 0.05);
        QVERIFY2(contrast >= 4.5, qPrintable(QString::number(contrast)));
      }
      QApplication::processEvents();
      QCOMPARE(window_->palette().color(QPalette::Window), palette.color(QPalette::Window));
    }
  }

  // Another process with twice as many pixels per length.
  void draws_at_twice_the_resolution() {
    if (qEnvironmentVariableIsSet("KOBOSHI_SCALED_TEST")) return;
    QProcess scaled;
    QProcessEnvironment environment = QProcessEnvironment::systemEnvironment();
    environment.insert(QStringLiteral("QT_SCALE_FACTOR"), QStringLiteral("2"));
    environment.insert(QStringLiteral("KOBOSHI_SCALED_TEST"), QStringLiteral("1"));
    scaled.setProcessEnvironment(environment);
    scaled.setProcessChannelMode(QProcess::MergedChannels);
    scaled.start(QCoreApplication::applicationFilePath(), {QStringLiteral("scaled_window")});
    QVERIFY(scaled.waitForFinished(3 * test::kPatience_ms));
    QVERIFY2(scaled.exitCode() == 0, scaled.readAll().constData());
  }
  void scaled_window() {
    if (!qEnvironmentVariableIsSet("KOBOSHI_SCALED_TEST")) return;
    QCOMPARE(window_->devicePixelRatioF(), 2.0);
    window_->resize(760, 560);
    QVERIFY(test::open(*window_, kRoot / "scenarios/walk.yaml"));
    RobotView& view = window_->view();
    QVERIFY(QTest::qWaitFor([&] { return view.frames() > 0; }, test::kPatience_ms));
    QCOMPARE(view.grab().toImage().width(), 2 * view.width());
    QCOMPARE(window_->grab().width(), 2 * window_->width());
  }
};

}  // namespace koboshi::studio

int main(int argc, char** argv) {
  return koboshi::studio::test::run_window_test<koboshi::studio::TextTest>(argc, argv);
}

#include "text_test.moc"
