#include "tools/cli/interrupt.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>

#include <sys/time.h>
#include <unistd.h>

namespace ivory {

namespace {

// Handlers may touch no more than these, and call only what POSIX lists as safe (setitimer() is a bare system call).
std::atomic<int> came{0};  // the signal
std::atomic<bool> answered{false};
std::atomic<bool> patient{false};
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free);

// The one not shown is written, then shown.
struct LastWords {
  std::array<char, 4096> text{};
  std::size_t length = 0;
};
std::array<LastWords, 2> last_words;
std::atomic<const LastWords*> shown{nullptr};

constexpr suseconds_t patience_us = 800'000;
constexpr time_t patience_s = 1;

void wait_a_moment() {
  const itimerval once{{0, 0}, {patience_s, patience_us}};
  ::setitimer(ITIMER_REAL, &once, nullptr);
}

extern "C" void ask_to_leave(int signal) {
  if (came.exchange(signal) != 0) ::_exit(128 + signal);
  wait_a_moment();
}

extern "C" void leave_unasked(int /*signal*/) {
  if (answered || came == 0) return;
  if (patient) return wait_a_moment();
  if (const LastWords* words = shown; words != nullptr) {
    [[maybe_unused]] const ssize_t unheard = ::write(STDERR_FILENO, words->text.data(), words->length);
  }
  ::_exit(128 + came);
}

using Action = struct sigaction;
constexpr std::array signals{SIGINT, SIGTERM, SIGALRM};
std::array<Action, signals.size()> old_actions;

}  // namespace

Interrupt::Interrupt() {
  came = 0;
  answered = false;
  patient = false;
  for (std::size_t i = 0; i < signals.size(); ++i) {
    ::sigaction(signals[i], nullptr, &old_actions[i]);
    if (signals[i] != SIGALRM && old_actions[i].sa_handler == SIG_IGN) continue;
    Action action{};
    action.sa_handler = signals[i] == SIGALRM ? leave_unasked : ask_to_leave;
    action.sa_flags = SA_RESTART;
    ::sigaction(signals[i], &action, nullptr);
  }
}

Interrupt::~Interrupt() {
  const itimerval never{};
  ::setitimer(ITIMER_REAL, &never, nullptr);
  for (std::size_t i = 0; i < signals.size(); ++i) ::sigaction(signals[i], &old_actions[i], nullptr);
  shown = nullptr;
}

bool Interrupt::asked() const {
  if (came == 0) return false;
  answered = true;
  return true;
}

void Interrupt::set_last_words(const std::string& line) {
  LastWords& words = shown == &last_words[0] ? last_words[1] : last_words[0];
  words.length = std::min(line.size(), words.text.size() - 1);
  std::copy_n(line.begin(), words.length, words.text.begin());
  words.text[words.length++] = '\n';
  shown = &words;
}

void Interrupt::be_patient(bool is) { patient = is; }

int interrupted_exit_code() { return came != 0 ? 128 + came : 1; }

}  // namespace ivory
