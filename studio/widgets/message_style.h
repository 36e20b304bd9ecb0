#pragma once

#include <QColor>
#include <QIcon>
#include <QPalette>
#include <QString>

#include "studio/widgets/message_kind.h"

namespace koboshi::studio {

// The word for a kind of message, translated: "Error".
[[nodiscard]] QString word_of(MessageKind kind);
// A shape of its own for each kind, so that no user depends on the colour.
[[nodiscard]] QIcon icon_of(MessageKind kind, const QPalette& palette);
// A colour for words, lines and marks on the palette's base.
[[nodiscard]] QColor colour_of(MessageKind kind, const QPalette& palette);
// A background on which the palette's text is readable.
[[nodiscard]] QColor background_of(MessageKind kind, const QPalette& palette);

}  // namespace koboshi::studio
