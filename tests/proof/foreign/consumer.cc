#include "firmware/app/controller.h"
#include "hal/port/board.h"

// The unused parameter causes a warning, which shows that the project's warnings are on.
int main(int count, char**) { unsigned unused = sizeof(koboshi::app::Controller) + count; }
