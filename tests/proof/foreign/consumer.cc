#include "firmware/app/controller.h"
#include "hal/port/board.h"

// Warns by itself, so that warnings of the repository's own would be seen.
int main(int count, char**) {
  unsigned unused = sizeof(koboshi::app::Controller) + count;
}
