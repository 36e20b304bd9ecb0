#pragma once

#include <QMetaType>

namespace koboshi::studio {

// The kind of a message. Success and information need no answer; an error names what did not happen.
enum class MessageKind { kSuccess, kInformation, kWarning, kError };

}  // namespace koboshi::studio

Q_DECLARE_METATYPE(koboshi::studio::MessageKind)
