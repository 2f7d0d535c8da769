// SPDX-License-Identifier: BSD-3-Clause
#include "watchdog.hpp"

#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>

#include "swivel/core/messages/bounds.hpp"
#include "swivel/core/messages/input_error.hpp"

namespace swivel::test {

namespace {

/// What a child tells its parent, in memory that both share.
struct Progress {
  int input, accepted, refused;
  char what[500];
};

void note(Progress& progress, const std::string& what) {
  std::snprintf(progress.what, sizeof progress.what, "%s", what.c_str());
}

/// Ends the process after so many seconds of processor time, since the machine may do other things;
/// a process that waits for something else may wait twenty times as long.
void kill_after(int seconds) {
  const itimerval timer{{0, 0}, {seconds, 0}};
  setitimer(ITIMER_PROF, &timer, nullptr);
  alarm(20 * static_cast<unsigned>(seconds));
}

/// Notes what is wrong with the input, if anything.
void run_one(Progress& progress, const Allowance& allowance, const std::function<void(int)>& read) {
  const Verdict verdict = judge([&] { read(progress.input); });
  progress.accepted += verdict.accepted;
  progress.refused += verdict.refused;
  if (!verdict.wrong.empty()) note(progress, verdict.wrong);
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  if (static_cast<std::size_t>(usage.ru_maxrss) / 1024 > allowance.megabytes)
    note(progress, "memory: " + std::to_string(usage.ru_maxrss / 1024) + " MB");
}

}  // namespace

Verdict judge(const std::function<void()>& read) {
  try {
    read();
  } catch (const InputError& error) {
    const std::string message = error.what();
    const bool fine = is_valid_name(message) && message.find("allowed") != std::string::npos &&
                      message.size() <= 4000;
    return {false, true,
            fine ? "" : "not one printable line that says what is allowed: " + printable(message)};
  } catch (const std::exception& error) {
    return {false, false, "thrown: " + printable(error.what())};
  }
  return {true, false, ""};
}

Tally watch(int count, const Allowance& allowance, const std::function<void(int)>& read) {
  void* const shared =
      mmap(nullptr, sizeof(Progress), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (shared == MAP_FAILED) throw std::runtime_error("mmap failed");
  auto& progress = *new (shared) Progress{};
  Tally tally;
  std::fflush(nullptr);
  while (progress.input < count) {
    progress.what[0] = '\0';
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("fork failed");
    if (child == 0) {
#if !defined(__SANITIZE_ADDRESS__)  // which reserves terabytes
      const rlimit most{std::size_t{4} << 30, std::size_t{4} << 30};
      setrlimit(RLIMIT_AS, &most);
#endif
      for (; progress.input < count; ++progress.input) {
        kill_after(allowance.seconds);
        run_one(progress, allowance, read);
        if (progress.what[0] != '\0') _exit(1);
      }
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0) break;
    std::string what = progress.what;
    if (WIFSIGNALED(status))
      what = WTERMSIG(status) == SIGPROF || WTERMSIG(status) == SIGALRM
                 ? "hangs"
                 : std::string("crash: ") + strsignal(WTERMSIG(status));
    if (what.empty())
      what = "ended with " + std::to_string(WEXITSTATUS(status));  // as sanitizers do
    tally.findings.push_back({progress.input, what});
    ++progress.input;
  }
  tally.accepted = progress.accepted;
  tally.refused = progress.refused;
  munmap(shared, sizeof(Progress));
  return tally;
}

}  // namespace swivel::test
