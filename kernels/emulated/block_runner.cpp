#include "kernels/emulated/block_runner.h"

#include <fmt/format.h>

#include <cstdlib>
#include <cstring>
#include <exception>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "kernels/emulated/cuda_words.h"
#include "kernels/emulated/futex.h"
#include "kernels/emulated/thread_pool.h"
#include "touchstone/contact.h"

namespace touchstone {
namespace {

std::atomic<std::uint64_t> block_order_seed{0};
std::atomic<std::uint64_t> launches_since_seed{0};

}  // namespace

void set_block_order_seed(std::uint64_t seed) {
  block_order_seed = seed;
  launches_since_seed = 0;
}

namespace emulated {
namespace {

// Thrown in a kernel's threads to end a launch that has already failed.
struct Aborted {};

// ThreadSanitizer must see that barriers order memory, and must not see more order than CUDA gives. Hence three choices:
// barriers wait on bare futexes (futex.h); votes and shuffles use relaxed atomics with fences, which order memory for the
// hardware but not for ThreadSanitizer; the count of running threads is relaxed.
enum class Orders { memory, nothing };

// One CUDA thread, and where in the source it last met others: for messages, and to notice threads that meet astray.
struct Thread {
  int block = 0;  // among the resident blocks
  int index = 0;  // in its block
  unsigned exchanges = 0;
  std::atomic<const char*> word{""}, kernel{""};
  std::atomic<std::uint32_t> line{0};

  void arrives_at(const char* a_word, const std::source_location& at) {
    word.store(a_word, std::memory_order_relaxed);
    kernel.store(at.function_name(), std::memory_order_relaxed);
    line.store(at.line(), std::memory_order_relaxed);
  }
  std::string place() const {
    const std::uint32_t at = line.load(std::memory_order_relaxed);
    const char* name = word.load(std::memory_order_relaxed);
    return at ? fmt::format("{} in line {} of {}", name, at, kernel.load(std::memory_order_relaxed)) : name;
  }
};

struct Barrier {
  std::uint32_t size = 0;
  Thread* first = nullptr;  // the threads that meet here lie one after another
  std::atomic<std::uint32_t> arrived{0}, generation{0};

  void open(std::uint32_t waiting, Orders orders, std::atomic<int>& running) {
    running.fetch_add(static_cast<int>(waiting), std::memory_order_relaxed);
    arrived.store(0, std::memory_order_relaxed);
    generation.fetch_add(1, orders == Orders::memory ? std::memory_order_release : std::memory_order_relaxed);
    wake_all(generation);
  }
};

struct Warp {
  Barrier barrier;
  WarpSlots slots[2];  // used in turn: a lane may be one exchange ahead of those that still read
};

struct Block {
  Barrier barrier;
  std::unique_ptr<Warp[]> warps;
  std::uint32_t number = 0;
  std::unique_ptr<void, void (*)(void*)> shared{nullptr, std::free};
};

// One kernel launch: the resident blocks (one, or all) and the threads that play them, again and again until none is left.
class Launch {
 public:
  Launch(std::int64_t blocks, int threads, std::size_t shared_bytes, std::int64_t resident, const std::function<void()>& body);
  void play(int thread);  // what OS thread number `thread` of resident*threads does
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

  void meet(Barrier& barrier, Orders orders, const char* word, const std::source_location& at);
  Barrier& barrier(Scope scope);
  Warp& warp();
  Block& block();
  Thread& me();

 private:
  void wait_to_open(Barrier& barrier, std::uint32_t generation);
  void next_blocks();
  void fail(std::exception_ptr error);
  void fail(const std::string& what) { fail(std::make_exception_ptr(std::runtime_error("emulated kernel: " + what))); }
  void same_place(const Barrier& barrier, const Thread& last);
  void deadlock();

  const std::function<void()>& body_;
  const int threads_;
  const std::size_t shared_bytes_;
  std::vector<std::uint32_t> order_;  // of block numbers
  std::size_t next_ = 0;              // in order_
  bool more_ = true;

  std::vector<Block> resident_;
  std::unique_ptr<Thread[]> thread_;
  Barrier grid_;              // grid_sync()
  Barrier end_;               // every thread comes here when it leaves the kernel
  std::atomic<int> running_;  // threads not waiting at any barrier: 0 is a deadlock
  std::atomic<bool> failed_{false};
  std::mutex error_mutex_;
  std::exception_ptr error_;
};

thread_local Launch* the_launch = nullptr;
thread_local int the_thread = 0;

Launch& current() {
  if (!the_launch) throw std::logic_error("a word of CUDA's kernels was used outside a kernel");
  return *the_launch;
}

std::vector<std::uint32_t> block_order(std::int64_t blocks) {
  std::vector<std::uint32_t> order(static_cast<std::size_t>(blocks));
  std::iota(order.begin(), order.end(), 0u);
  const std::uint64_t seed = block_order_seed;
  if (seed == 0) return order;
  std::uint64_t state = splitmix64(seed) + launches_since_seed++;
  for (std::size_t left = order.size(); left > 1; --left) std::swap(order[left - 1], order[(state = splitmix64(state)) % left]);
  return order;
}

Launch::Launch(std::int64_t blocks, int threads, std::size_t shared_bytes, std::int64_t resident,
               const std::function<void()>& body)
    : body_(body), threads_(threads), shared_bytes_(shared_bytes), order_(block_order(blocks)), resident_(resident) {
  const int all = static_cast<int>(resident) * threads;
  thread_ = std::make_unique<Thread[]>(all);
  const auto shape = [](Barrier& barrier, Thread* first, int size) {
    barrier.first = first;
    barrier.size = static_cast<std::uint32_t>(size);
  };
  shape(grid_, thread_.get(), all);
  shape(end_, thread_.get(), all);
  for (int b = 0; b < resident; ++b) {
    Thread* const first = thread_.get() + b * threads;
    shape(resident_[b].barrier, first, threads);
    resident_[b].warps = std::make_unique<Warp[]>(threads / kWarp);
    for (int w = 0; w < threads / kWarp; ++w) shape(resident_[b].warps[w].barrier, first + w * kWarp, kWarp);
    for (int t = 0; t < threads; ++t) first[t].block = b, first[t].index = t;
  }
  running_ = all;
  next_blocks();
}

// Gives each resident block the next number and fresh shared memory.
void Launch::next_blocks() {
  more_ = next_ < order_.size() && !failed_;
  for (Block& block : resident_) {
    block.shared.reset();
    if (!more_) continue;
    block.number = order_[next_++];
    block.shared.reset(std::malloc(shared_bytes_));
    if (shared_bytes_) std::memset(block.shared.get(), 0xCD, shared_bytes_);
  }
}

Thread& Launch::me() { return thread_[the_thread]; }
Block& Launch::block() { return resident_[me().block]; }
Warp& Launch::warp() { return block().warps[me().index / kWarp]; }
Barrier& Launch::barrier(Scope scope) {
  if (scope == Scope::warp) return warp().barrier;
  if (scope == Scope::block) return block().barrier;
  if (order_.size() > resident_.size())
    throw std::runtime_error("emulated kernel: grid_sync() wants all blocks at once: start it by launch_together()");
  return grid_;
}

void Launch::play(int thread) {
  the_launch = this;
  the_thread = thread;
  threadIdx.x = static_cast<unsigned>(me().index);
  blockDim.x = static_cast<unsigned>(threads_);
  gridDim.x = static_cast<unsigned>(order_.size());
  while (more_) {
    blockIdx.x = block().number;
    try {
      body_();
    } catch (const Aborted&) {
    } catch (...) {
      fail(std::current_exception());
    }
    me().arrives_at("the end of the kernel", {});
    const std::uint32_t generation = end_.generation.load(std::memory_order_acquire);
    if (end_.arrived.fetch_add(1, std::memory_order_acq_rel) + 1 == end_.size) {
      next_blocks();
      end_.open(end_.size - 1, Orders::memory, running_);
    } else {
      wait_to_open(end_, generation);
    }
  }
  the_launch = nullptr;
}

void Launch::meet(Barrier& barrier, Orders orders, const char* word, const std::source_location& at) {
  if (failed_.load(std::memory_order_relaxed)) throw Aborted{};
  me().arrives_at(word, at);
  const bool ordered = orders == Orders::memory;
  const std::uint32_t generation = barrier.generation.load(std::memory_order_acquire);
  if (barrier.arrived.fetch_add(1, ordered ? std::memory_order_acq_rel : std::memory_order_relaxed) + 1 == barrier.size) {
    same_place(barrier, me());
    barrier.open(barrier.size - 1, orders, running_);
  } else {
    wait_to_open(barrier, generation);
  }
  if (failed_.load(std::memory_order_relaxed)) throw Aborted{};
}

void Launch::wait_to_open(Barrier& barrier, std::uint32_t generation) {
  if (running_.fetch_sub(1, std::memory_order_relaxed) == 1) deadlock();
  wait_while(barrier.generation, generation);
}

// The first error is the one reported. All others who meet from now on leave the kernel.
void Launch::fail(std::exception_ptr error) {
  const std::lock_guard lock(error_mutex_);
  if (!error_) error_ = std::move(error);
  failed_.store(true, std::memory_order_relaxed);
}

// Called by the last to arrive. CUDA leaves it undefined what happens when lanes of one collective differ in the source.
void Launch::same_place(const Barrier& barrier, const Thread& last) {
  for (std::uint32_t k = 0; k < barrier.size; ++k) {
    const Thread& other = barrier.first[k];
    if (other.line.load(std::memory_order_relaxed) == last.line.load(std::memory_order_relaxed) &&
        other.word.load(std::memory_order_relaxed) == last.word.load(std::memory_order_relaxed))
      continue;
    return fail(fmt::format("block {}: threads {} and {} meet at different places: {} and {}", resident_[last.block].number,
                            other.index, last.index, other.place(), last.place()));
  }
}

// Nobody runs, yet not all are at the end: those who wait at other barriers wait for ever. Says who waits where, and lets
// them go, each to leave the kernel.
void Launch::deadlock() {
  if (!failed_) {
    std::map<std::string, int> waiting;
    for (std::uint32_t k = 0; k < end_.size; ++k) ++waiting[thread_[k].place()];
    std::string who;
    for (const auto& [place, count] : waiting) who += fmt::format("{}{} at {}", who.empty() ? "" : ", ", count, place);
    fail(fmt::format("block {} can never go on; of its threads wait: {}", block().number, who));
  }
  const auto release = [this](Barrier& barrier) {
    if (const std::uint32_t waiting = barrier.arrived.load(std::memory_order_acquire))
      barrier.open(waiting, Orders::memory, running_);
  };
  release(grid_);
  for (Block& block : resident_) {
    release(block.barrier);
    for (int w = 0; w < threads_ / kWarp; ++w) release(block.warps[w].barrier);
  }
}

void refuse(const std::string& what) { throw std::runtime_error("emulated launch: " + what); }

}  // namespace

void run(std::int64_t blocks, int threads, std::size_t shared_bytes, Residency residency, const std::function<void()>& body) {
  constexpr std::int64_t kMostBlocks = 0x7FFFFFFF;
  constexpr int kMostThreads = 1024;
  constexpr std::size_t kMostShared = 227 * 1024;  // an H100's; other cards have less
  if (threads < kWarp || threads > kMostThreads || threads % kWarp)
    refuse(fmt::format("{} threads a block; it must be a multiple of 32 up to {}", threads, kMostThreads));
  if (blocks < 1 || blocks > kMostBlocks) refuse(fmt::format("{} blocks; it must be 1 to {}", blocks, kMostBlocks));
  if (shared_bytes > kMostShared) refuse(fmt::format("{} bytes of shared memory a block; at most {}", shared_bytes, kMostShared));
  const std::int64_t resident = residency == Residency::all_at_once ? blocks : 1;
  if (resident * threads > kMostThreads)
    refuse(fmt::format("{} blocks of {} threads at once; at most {} threads in all", blocks, threads, kMostThreads));

  static ThreadPool pool;
  Launch launch(blocks, threads, shared_bytes, resident, body);
  pool.run(static_cast<int>(resident) * threads, [&](int thread) { launch.play(thread); });
  launch.rethrow();
}

void* shared_memory() { return current().block().shared.get(); }

void wait(Scope scope, const char* word, std::source_location at) {
  Launch& launch = current();
  launch.meet(launch.barrier(scope), Orders::memory, word, at);
}

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wtsan"  // "fences are not supported": that ThreadSanitizer overlooks them is the point

const WarpSlots& exchange(unsigned mask, std::uint64_t value, const char* word, std::source_location at) {
  require_full_warp(mask, word, at);
  Launch& launch = current();
  WarpSlots& slots = launch.warp().slots[launch.me().exchanges++ & 1];
  slots[launch.me().index % kWarp].store(value, std::memory_order_relaxed);
  std::atomic_thread_fence(std::memory_order_seq_cst);
  launch.meet(launch.warp().barrier, Orders::nothing, word, at);
  std::atomic_thread_fence(std::memory_order_seq_cst);
  return slots;
}

#pragma GCC diagnostic pop

void require_full_warp(unsigned mask, const char* word, std::source_location at) {
  if (mask != 0xFFFFFFFFu)
    throw std::runtime_error(fmt::format("emulated kernel: {} in line {} of {}: mask {:#x}; this dialect knows whole warps only",
                                         word, at.line(), at.function_name(), mask));
}

}  // namespace emulated
}  // namespace touchstone
