#pragma once

#include <csignal>
#include <map>

namespace mpm::run {

/// From construction to destruction signals ask a run for something instead of ending the program:
/// USR1 for a checkpoint; USR2, TERM, INT and HUP for a checkpoint and an end. PIPE is ignored, so
/// that a reader of the output who goes away costs no run, and XFSZ, so that a file that must not
/// grow is an error like others. A second INT ends the program at once. For programs, not for
/// libraries: there is one at a time, made once MPI and PETSc have theirs.
class SignalHandlers {
 public:
  SignalHandlers();
  ~SignalHandlers();
  SignalHandlers(const SignalHandlers&) = delete;
  SignalHandlers& operator=(const SignalHandlers&) = delete;

 private:
  void install(int signal, void (*handler)(int), int flags);

  std::map<int, struct sigaction> m_before;
};

/// Whether this rank has been asked for a checkpoint since the last call. Local.
bool take_request_for_checkpoint();
/// Whether it has been asked to end. Local.
bool is_asked_to_end();
/// Forgets what this rank has been asked for. Local.
void forget_signals();

}  // namespace mpm::run
