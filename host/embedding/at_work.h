// Work on a device, and the end of the process: a driver's own statics (LLVM's, of Mesa's software device)
// are destroyed in std::exit(), and work that is under way then crashes or hangs.
#pragma once

namespace rosefusion {

/// Held while a device works. std::exit() waits for those of other threads, 10 seconds at most; what they
/// begin later does not begin any more, and the thread stays there until the process has ended.
class AtWork {
 public:
  AtWork();
  /// Where that would be too late: returns, and `begun` is false.
  explicit AtWork(bool& begun);
  ~AtWork();
  AtWork(const AtWork&) = delete;
  AtWork& operator=(const AtWork&) = delete;

 private:
  bool begun_ = true;
};

}  // namespace rosefusion
