// What the window shows in words: translations, shortcuts, tooltips, colours and resolution.

#include <QAbstractItemModel>
#include <QAbstractSpinBox>
#include <QComboBox>
#include <QDockWidget>
#include <QDoubleSpinBox>
#include <QFile>
#include <QGroupBox>
#include <QHeaderView>
#include <QLabel>
#include <QLineEdit>
#include <QMenu>
#include <QProcess>
#include <QRegularExpression>
#include <QTabBar>
#include <QTableView>
#include <QTemporaryDir>
#include <QToolButton>
#include <QTranslator>
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "tests/studio/window/window_fixture.h"
#include "tools/studio/window/theme.h"
#include "tools/studio/window/translation.h"

namespace koboshi::studio {

using test::kRoot;

// A text in a language whose texts are 40 % longer and in guillemets, so that a text that is not translated
// shows. Shortcuts stay.
QString pseudo(const QString& text) {
  static const QRegularExpression keys(QStringLiteral("^(Ctrl|Alt|Shift)\\+"));
  if (keys.match(text).hasMatch()) return text;
  const int more = static_cast<int>(std::ceil(0.4 * static_cast<double>(text.size())));
  return QChar(u'«') + text + QString(more, QLatin1Char('o')) + QChar(u'»');
}

// The language without files, where Qt's tools for translations are not installed.
class PseudoLocale final : public QTranslator {
 public:
  QString translate(const char* /*context*/, const char* source, const char* /*meaning*/,
                    int /*n*/) const override {
    return pseudo(QString::fromUtf8(source));
  }
  bool isEmpty() const override { return false; }
};

#ifdef KOBOSHI_LUPDATE
bool run_tool(const char* program, const QStringList& arguments) {
  QProcess tool;
  tool.setProcessChannelMode(QProcess::ForwardedErrorChannel);
  tool.start(QLatin1String(program), arguments);
  return tool.waitForFinished(test::kPatience_ms) && tool.exitCode() == 0;
}

// Translates the studio as a translator does: lupdate collects the texts, lrelease compiles them. Null: it
// did not work.
std::unique_ptr<QTranslator> translate_studio(const QString& folder) {
  const QString root = QString::fromStdString(kRoot.string());
  const QString texts = folder + QStringLiteral("/koboshi_de.ts");
  if (!run_tool(KOBOSHI_LUPDATE, {QStringLiteral("-silent"), QStringLiteral("-recursive"),
                                  root + QStringLiteral("/tools/studio"), QStringLiteral("-I"), root,
                                  QStringLiteral("-ts"), texts}))
    return nullptr;
  QFile file(texts);
  if (!file.open(QIODevice::ReadOnly)) return nullptr;
  const QString found = QString::fromUtf8(file.readAll());
  file.close();
  static const QRegularExpression message(
      QStringLiteral("<source>([^<]*)</source>(.*?)<translation type=\"unfinished\"></translation>"),
      QRegularExpression::DotMatchesEverythingOption);
  QString translated;
  qsizetype end = 0;
  for (auto all = message.globalMatch(found); all.hasNext();) {
    const QRegularExpressionMatch one = all.next();
    translated += found.mid(end, one.capturedStart() - end) + QStringLiteral("<source>") + one.captured(1) +
                  QStringLiteral("</source>") + one.captured(2) + QStringLiteral("<translation>") +
                  pseudo(one.captured(1)) + QStringLiteral("</translation>");
    end = one.capturedEnd();
  }
  translated += found.mid(end);
  if (!file.open(QIODevice::WriteOnly)) return nullptr;
  file.write(translated.toUtf8());
  file.close();
  if (!run_tool(KOBOSHI_LRELEASE, {QStringLiteral("-silent"), texts})) return nullptr;
  return load_translation(QLocale(QStringLiteral("de_AT")), folder);
}
#else
std::unique_ptr<QTranslator> translate_studio(const QString& /*folder*/) {
  return std::make_unique<PseudoLocale>();
}
#endif

class TextTest final : public QObject {
  Q_OBJECT

 private:
  std::unique_ptr<MainWindow> window_;
  QTemporaryDir folder_;
  std::unique_ptr<QTranslator> locale_;

  // What is missing in one line; without doubles.
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
    QCOMPARE(view.grabFramebuffer().width(), 2 * view.width());
    QCOMPARE(window_->grab().width(), 2 * window_->width());
  }
};

}  // namespace koboshi::studio

int main(int argc, char** argv) {
  return koboshi::studio::test::run_window_test<koboshi::studio::TextTest>(argc, argv);
}

#include "text_test.moc"
