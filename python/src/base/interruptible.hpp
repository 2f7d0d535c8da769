// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <chrono>
#include <condition_variable>
#include <exception>
#include <list>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <stop_token>
#include <thread>
#include <type_traits>

#include "base/bindings.hpp"
#include "swivel/core/base/budget.hpp"

namespace swivel::python {

/// One piece of work under way. A thread that Python leaves behind when it ends could not take up
/// an answer; therefore end_all() stops all work and waits for it, and no work begins afterwards.
class UnderWay {
 public:
  /// Registers work that `stop` stops. Throws RuntimeError if Python is ending.
  explicit UnderWay(std::stop_source stop) {
    All& all = UnderWay::all();
    const std::lock_guard lock(all.mutex);
    if (all.closed) throw std::runtime_error("Python ends: nothing more is planned");
    place_ = all.stops.insert(all.stops.end(), std::move(stop));
  }
  ~UnderWay() {
    All& all = UnderWay::all();
    const std::lock_guard lock(all.mutex);
    all.stops.erase(place_);
    all.ended.notify_all();
  }
  UnderWay(const UnderWay&) = delete;
  UnderWay& operator=(const UnderWay&) = delete;

  static void end_all() {
    const py::gil_scoped_release released;
    All& all = UnderWay::all();
    std::unique_lock lock(all.mutex);
    all.closed = true;
    for (std::stop_source& stop : all.stops) stop.request_stop();
    all.ended.wait(lock, [&] { return all.stops.empty(); });
  }

 private:
  struct All {
    std::mutex mutex;
    std::condition_variable ended;
    std::list<std::stop_source> stops;
    bool closed = false;
  };
  static All& all() {
    static auto* const all = new All;  // never destroyed, as threads may use it to the end
    return *all;
  }
  std::list<std::stop_source>::iterator place_;
};

/// Returns whether this is Python's main thread, which alone handles signals.
inline bool handles_signals() {
  return py::module_::import("threading")
             .attr("main_thread")()
             .attr("ident")
             .cast<unsigned long>() == PyThread_get_thread_ident();
}

/// Calls work() on a thread of its own while this thread lets Python handle its signals. If a
/// signal handler raises, as that of Ctrl-C does, requests `stop` and raises the same exception
/// once the work has ended. The caller holds the interpreter's lock before and after.
template <class Work>
void with_signals(const Work& work, std::stop_source& stop) {
  constexpr auto kBetweenLooks = std::chrono::milliseconds(10);
  std::exception_ptr error;
  std::optional<py::error_already_set> interrupt;
  bool ended = false;
  std::mutex mutex;
  std::condition_variable end;
  std::optional<py::gil_scoped_release> released(std::in_place);
  std::jthread worker([&] {
    try {
      work();
    } catch (...) {
      error = std::current_exception();
    }
    const std::lock_guard lock(mutex);
    ended = true;
    end.notify_one();
  });
  for (std::unique_lock lock(mutex); !end.wait_for(lock, kBetweenLooks, [&] { return ended; });) {
    if (interrupt) continue;
    lock.unlock();
    released.reset();
    if (PyErr_CheckSignals() != 0) {
      interrupt.emplace();  // takes the exception that was raised
      stop.request_stop();
    }
    released.emplace();
    lock.lock();
  }
  worker.join();
  released.reset();
  if (interrupt) throw py::error_already_set(std::move(*interrupt));
  if (error) std::rethrow_exception(std::exchange(error, nullptr));
}

/// Returns work(stop), called without the interpreter's lock, and interrupted by Python's signals
/// if this thread handles them. Throws what the work throws; Stopped becomes TimeoutError, since
/// only a timeout stops the work.
template <class Work>
auto interruptible(const Work& work) {
  std::optional<std::invoke_result_t<Work, std::stop_token>> result;
  std::stop_source stop;
  const UnderWay under_way(stop);
  const auto run = [&] { result.emplace(work(stop.get_token())); };
  try {
    if (handles_signals()) {
      with_signals(run, stop);
    } else {
      const py::gil_scoped_release released;
      run();
    }
  } catch (const Stopped&) {
    PyErr_SetString(PyExc_TimeoutError, "stopped by its timeout");
    throw py::error_already_set();
  }
  return std::move(*result);
}

}  // namespace swivel::python
