#pragma once

#include "tools/teleop/key_queue.h"
#include "view/live/live_view.h"

namespace koboshi::tools {

// The operator's keys for the pages of a live view; they go into this queue, which must outlive the view.
[[nodiscard]] view::PageKeys page_keys(KeyQueue& queue);

}  // namespace koboshi::tools
