// The interpreter given to other threads, and taken back unless it has ended meanwhile.
#pragma once
#include <pybind11/pybind11.h>

#include <chrono>
#include <thread>
#ifdef __GLIBCXX__
#include <cxxabi.h>
#endif

/// Runs `work`, which takes the interpreter. Once that has ended, Python before 3.14 ends such a thread (a
/// daemon: nobody waits for it) by unwinding its stack, through destructors that give back what is no longer
/// there; it stays here instead, until the process has ended.
template <typename Work>
void unlessPythonEnded(const Work& work) {
#ifdef __GLIBCXX__
  try {
    work();
  } catch (const abi::__forced_unwind&) {
    for (;;) std::this_thread::sleep_for(std::chrono::hours(1));
  }
#else
  work();
#endif
}

/// While it lives, other threads run Python.
class OthersMayRun {
 public:
  OthersMayRun() : state_(PyEval_SaveThread()) {}
  ~OthersMayRun() {
    unlessPythonEnded([this] { PyEval_RestoreThread(state_); });
  }
  OthersMayRun(const OthersMayRun&) = delete;
  OthersMayRun& operator=(const OthersMayRun&) = delete;

 private:
  PyThreadState* state_;
};
