// The oracle: every pair is asked, in_contact() decides, nothing else. O(n^2).
#pragma once

#include <span>

#include "touchstone/ball.h"
#include "touchstone/contact_list.h"

namespace touchstone {

// All contacts of `balls`, pairs in ascending order. 20,653 balls take about half a second.
ContactList all_pairs(std::span<const Ball> balls);

}  // namespace touchstone
