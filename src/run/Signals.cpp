#include "mpm/run/Signals.hpp"

namespace mpm::run {
namespace {

volatile std::sig_atomic_t wants_checkpoint = 0;
volatile std::sig_atomic_t wants_end = 0;

extern "C" void ask_for_checkpoint(int) {
  wants_checkpoint = 1;
}
extern "C" void ask_for_end(int) {
  wants_end = 1;
}

}  // namespace

SignalHandlers::SignalHandlers() {
  forget_signals();
  install(SIGUSR1, ask_for_checkpoint, SA_RESTART);
  for (const int signal : {SIGUSR2, SIGTERM, SIGHUP}) install(signal, ask_for_end, SA_RESTART);
  install(SIGINT, ask_for_end, SA_RESTART | SA_RESETHAND);
  for (const int signal : {SIGPIPE, SIGXFSZ}) install(signal, SIG_IGN, 0);
}

SignalHandlers::~SignalHandlers() {
  for (const auto& [signal, action] : m_before) sigaction(signal, &action, nullptr);
}

/// What the caller has told the program to ignore (nohup) stays ignored.
void SignalHandlers::install(int signal, void (*handler)(int), int flags) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = flags;
  sigemptyset(&action.sa_mask);
  struct sigaction before {};
  sigaction(signal, nullptr, &before);
  if (before.sa_handler == SIG_IGN) return;
  m_before[signal] = before;
  sigaction(signal, &action, nullptr);
}

bool take_request_for_checkpoint() {
  const bool asked = wants_checkpoint != 0;
  wants_checkpoint = 0;
  return asked;
}

bool is_asked_to_end() {
  return wants_end != 0;
}

void forget_signals() {
  wants_checkpoint = 0;
  wants_end = 0;
}

}  // namespace mpm::run
