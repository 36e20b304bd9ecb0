#include "studio/widgets/translation.h"

#include <QTranslator>

namespace koboshi::studio {

std::unique_ptr<QTranslator> load_translation(const QLocale& locale, const QString& folder) {
  auto translator = std::make_unique<QTranslator>();
  if (!translator->load(locale, QStringLiteral("koboshi"), QStringLiteral("_"), folder)) return nullptr;
  return translator;
}

}  // namespace koboshi::studio
