// Ctrl-C asks politely: the sample at hand is finished, what is done is written. A second Ctrl-C ends the program at once.
#pragma once

#include "touchstone/progress.h"

namespace touchstone {

void catch_interrupts();
bool interrupted();
inline void stop_if_interrupted() {
  if (interrupted()) throw Interrupted();
}

}  // namespace touchstone
