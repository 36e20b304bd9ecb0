#pragma once

#include <QFile>
#include <QLocale>
#include <QProcess>
#include <QRegularExpression>
#include <QTranslator>
#include <cmath>
#include <memory>

#include "studio/widgets/translation.h"
#include "tests/studio/window/window_fixture.h"

namespace koboshi::studio {

// A text in a language whose texts are 40 % longer and in guillemets, so that a text that is not translated
// shows. Shortcuts stay.
inline QString pseudo(const QString& text) {
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
inline bool run_tool(const char* program, const QStringList& arguments) {
  QProcess tool;
  tool.setProcessChannelMode(QProcess::ForwardedErrorChannel);
  tool.start(QLatin1String(program), arguments);
  return tool.waitForFinished(test::kPatience_ms) && tool.exitCode() == 0;
}

// Translates the studio as a translator does: lupdate collects the texts, lrelease compiles them. Null: it
// did not work.
inline std::unique_ptr<QTranslator> translate_studio(const QString& folder) {
  const QString root = QString::fromStdString(test::kRoot.string());
  const QString texts = folder + QStringLiteral("/koboshi_de.ts");
  if (!run_tool(KOBOSHI_LUPDATE,
                {QStringLiteral("-silent"), QStringLiteral("-recursive"), root + QStringLiteral("/studio"),
                 QStringLiteral("-I"), root, QStringLiteral("-ts"), texts}))
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
inline std::unique_ptr<QTranslator> translate_studio(const QString& /*folder*/) {
  return std::make_unique<PseudoLocale>();
}
#endif

}  // namespace koboshi::studio
