#pragma once

#include <QLocale>
#include <QString>
#include <memory>

class QTranslator;

namespace koboshi::studio {

// Loads the studio's texts in this language from koboshi_LANGUAGE.qm in a folder: the nearest there is, so
// koboshi_de.qm for de_AT. Null: there is none, and the texts are English.
std::unique_ptr<QTranslator> load_translation(const QLocale& locale, const QString& folder);

}  // namespace koboshi::studio
