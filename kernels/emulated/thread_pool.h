// OS threads kept from launch to launch: starting hundreds anew for each kernel would take longer than the kernel.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

#include "kernels/emulated/futex.h"

namespace touchstone::emulated {

// As many threads as the largest launch so far asked for.
class ThreadPool {
 public:
  ~ThreadPool() {
    stop_ = true;
    for (Worker& worker : workers_) worker.start();
    for (Worker& worker : workers_) worker.thread.join();
  }

  // work(0) … work(count - 1), all at the same time; work must not throw. One caller at a time.
  void run(int count, const std::function<void(int)>& work) {
    const std::lock_guard one_caller(mutex_);
    work_ = &work;
    busy_ = static_cast<std::uint32_t>(count);
    while (static_cast<int>(workers_.size()) < count) {
      Worker& worker = workers_.emplace_back();
      worker.thread = std::thread([this, &worker, number = static_cast<int>(workers_.size()) - 1] { serve(worker, number); });
    }
    for (int number = 0; number < count; ++number) workers_[number].start();
    while (const std::uint32_t left = busy_) wait_while(busy_, left);
  }

 private:
  struct Worker {
    std::thread thread;
    std::atomic<std::uint32_t> round{0};
    void start() {
      ++round;
      wake_all(round);
    }
  };

  void serve(Worker& worker, int number) {
    for (std::uint32_t round = 0;; ++round) {
      wait_while(worker.round, round);
      if (stop_) return;
      (*work_)(number);
      if (--busy_ == 0) wake_all(busy_);
    }
  }

  std::mutex mutex_;
  std::deque<Worker> workers_;  // a deque: workers stay where they are
  const std::function<void(int)>* work_ = nullptr;
  std::atomic<std::uint32_t> busy_{0};
  std::atomic<bool> stop_{false};
};

}  // namespace touchstone::emulated
