// OS threads kept from launch to launch: starting hundreds anew for each kernel would take longer than the kernel.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace touchstone::emulated {

// OS threads kept for all launches of the program, as many as the largest asked for.
class ThreadPool {
 public:
  ~ThreadPool() {
    {
      const std::lock_guard lock(mutex_);
      stop_ = true;
    }
    start_.notify_all();
    for (std::thread& worker : workers_) worker.join();
  }

  // work(0) … work(count - 1), all at the same time. One caller at a time.
  void run(int count, const std::function<void(int)>& work) {
    const std::lock_guard one_caller(caller_mutex_);
    std::unique_lock lock(mutex_);
    while (static_cast<int>(workers_.size()) < count)
      workers_.emplace_back([this, number = static_cast<int>(workers_.size()), round = round_] { serve(number, round); });
    work_ = &work;
    wanted_ = busy_ = count;
    ++round_;
    start_.notify_all();
    done_.wait(lock, [this] { return busy_ == 0; });
  }

 private:
  void serve(int number, std::uint64_t round) {
    std::unique_lock lock(mutex_);
    for (;;) {
      start_.wait(lock, [&] { return stop_ || round_ != round; });
      if (stop_) return;
      round = round_;
      if (number >= wanted_) continue;
      const std::function<void(int)>& work = *work_;
      lock.unlock();
      work(number);
      lock.lock();
      if (--busy_ == 0) done_.notify_one();
    }
  }

  std::mutex caller_mutex_, mutex_;
  std::condition_variable start_, done_;
  std::vector<std::thread> workers_;
  const std::function<void(int)>* work_ = nullptr;
  int wanted_ = 0, busy_ = 0;
  std::uint64_t round_ = 0;
  bool stop_ = false;
};

}  // namespace touchstone::emulated
