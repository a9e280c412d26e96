// A user's program decides contacts as the library does only if it rounds every operation: touchstone::reference must bring the
// flag that forbids contraction to FMA. Exits with the number of near-touching pairs, at most 100, that it decides otherwise.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

#include "touchstone/contact.h"

// Apart from the other, or the compiler shares their products, and then does not contract either.
[[gnu::noinline]] static bool in_contact_here(const touchstone::Ball& a, const touchstone::Ball& b) {
  return touchstone::in_contact(a, b);
}

// The rule in double, where sums and products of two floats are exact, rounded by hand after each operation.
[[gnu::noinline]] static bool in_contact_by_hand(const touchstone::Ball& a, const touchstone::Ball& b) {
  const auto rounded = [](double v) { return static_cast<double>(static_cast<float>(v)); };
  const double dx = rounded(double{a.x} - b.x), dy = rounded(double{a.y} - b.y), dz = rounded(double{a.z} - b.z);
  const double reach = rounded(double{a.r} + b.r);
  return rounded(rounded(rounded(dx * dx) + rounded(dy * dy)) + rounded(dz * dz)) < rounded(reach * reach);
}

int main() {
  std::mt19937 random(1);
  const auto unit = [&] { return static_cast<double>(random()) / 4294967296.0; };
  int differ = 0;
  for (int t = 0; t < 100'000; ++t) {
    const touchstone::Ball a{0, 0, 0, static_cast<float>(0.0025 + 0.0075 * unit())};
    const double d[3] = {unit() - 0.5, unit() - 0.5, unit() - 0.5};
    const float r = static_cast<float>(0.0025 + 0.0075 * unit());
    const double scale = (static_cast<double>(a.r) + r) / std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    const touchstone::Ball b{static_cast<float>(scale * d[0]), static_cast<float>(scale * d[1]), static_cast<float>(scale * d[2]),
                             r};
    differ += in_contact_here(a, b) != in_contact_by_hand(a, b);
  }
  std::printf("%d of 100000 near-touching pairs decided otherwise\n", differ);
  return std::min(differ, 100);
}
