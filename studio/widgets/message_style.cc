#include "studio/widgets/message_style.h"

#include <QCoreApplication>

#include "studio/widgets/colours.h"
#include "studio/widgets/step_icons.h"

namespace koboshi::studio {

using simulation::Severity;

QString word_of(MessageKind kind) {
  switch (kind) {
    case MessageKind::kSuccess:
      return QCoreApplication::translate("Message", "Done");
    case MessageKind::kInformation:
      return QCoreApplication::translate("Message", "Note");
    case MessageKind::kWarning:
      return QCoreApplication::translate("Message", "Warning");
    case MessageKind::kError:
      return QCoreApplication::translate("Message", "Error");
  }
  return {};
}

QIcon icon_of(MessageKind kind, const QPalette& palette) {
  if (kind == MessageKind::kSuccess) return good_icon(palette);
  if (kind == MessageKind::kInformation) return severity_icon(Severity::kNote, palette);
  return severity_icon(kind == MessageKind::kError ? Severity::kError : Severity::kWarning, palette);
}

QColor colour_of(MessageKind kind, const QPalette& palette) {
  const Colours colours = colours_of(palette);
  if (kind == MessageKind::kSuccess) return colours.stable;
  if (kind == MessageKind::kInformation) return colours.note;
  return kind == MessageKind::kError ? colours.error : colours.warning;
}

QColor background_of(MessageKind kind, const QPalette& palette) {
  constexpr float kShare = 0.18F;
  return mixed(palette.color(QPalette::Base), colour_of(kind, palette), kShare);
}

}  // namespace koboshi::studio
