// The end of the process while a Reconstructor lives, and fork() beside it.
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <optional>
#include <thread>

#include "rosefusion/vulkan.h"
#include "tests/engine/validating_device.h"
#include "tests/host/embedding/caller_handles.h"
#include "tests/host/embedding/frames.h"

namespace rosefusion::testing {
namespace test_processes {

using ::testing::ExitedWithCode;

/// Destroyed after all that is loaded later: Vulkan's loader, the driver, LLVM.
std::optional<Reconstructor> kept;

Options withAQueue() {
  Options options = coarseOptions();
  options.queue_length = 16;
  return options;
}

/// Frames are under way and waiting.
void pushFrames(Reconstructor& reconstructor) {
  for (std::size_t i = 0; i < 16; ++i) reconstructor.push(publicFrame(i % 4));
  while (!reconstructor.poll()) std::this_thread::yield();
}

class Exit : public ::testing::Test {
 protected:
  Exit() { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

TEST_F(Exit, OneInAStaticVariableOfTheProgram) {
  EXPECT_EXIT(
      {
        kept.emplace(publicCamera(), withAQueue());
        pushFrames(*kept);
        std::exit(0);
      },
      ExitedWithCode(0), "");
}

TEST_F(Exit, OneInAStaticVariableOfAFunction) {
  EXPECT_EXIT(
      {
        static Reconstructor late(publicCamera(), withAQueue());
        pushFrames(late);
        std::exit(0);
      },
      ExitedWithCode(0), "");
}

#ifndef __SANITIZE_THREAD__  // which calls a thread that is never joined a mistake
TEST_F(Exit, OneThatIsNeverDestroyed) {
  // Which is a leak to the address sanitizer, that the child starts with.
  const char* const options = std::getenv("LSAN_OPTIONS");
  const std::string before = options ? options : "";
  setenv("LSAN_OPTIONS", "detect_leaks=0", 1);
  EXPECT_EXIT(
      {
        static Reconstructor* const for_good = new Reconstructor(publicCamera(), withAQueue());
        pushFrames(*for_good);
        std::exit(0);
      },
      ExitedWithCode(0), "");
  options ? setenv("LSAN_OPTIONS", before.c_str(), 1) : unsetenv("LSAN_OPTIONS");
}

#endif

/// What the child's work made of it: its exit code, or what killed it. It is given 20 seconds.
template <typename Work>
std::string childsEnd(Work work) {
  const pid_t child = fork();
  if (child == 0) {
    int code = 99;
    try {
      code = work();
    } catch (...) {
    }
    _exit(code);
  }
  for (int waited = 0; waited < 2000; ++waited) {
    int status = 0;
    if (waitpid(child, &status, WNOHANG) == child)
      return WIFEXITED(status) ? "exit code " + std::to_string(WEXITSTATUS(status))
                               : "signal " + std::to_string(WTERMSIG(status));
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  return "it hangs";
}

TEST(Fork, AProgramMayBeStartedMeanwhile) {
  Reconstructor reconstructor(publicCamera(), withAQueue());
  for (std::size_t i = 0; i < 4; ++i) ASSERT_TRUE(reconstructor.push(publicFrame(i)));
  EXPECT_EQ(childsEnd([] { return execl("/bin/true", "true", nullptr); }), "exit code 0");
  reconstructor.wait();
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NE(reconstructor.poll()->status, Status::Lost) << i;
}

TEST(Fork, IsRefusedInTheChildWithoutWaiting) {
  Caller caller;
  VulkanHandles handles = handlesOf(caller);
  handles.lock_queue = [&] { caller.queue_mutex.lock(); };
  handles.unlock_queue = [&] { caller.queue_mutex.unlock(); };
  std::optional<Reconstructor> own(std::in_place, publicCamera(), withAQueue()),
      callers(std::in_place, publicCamera(), handles, withAQueue());
  for (Reconstructor* r : {&*own, &*callers})
    for (std::size_t i = 0; i < 16; ++i) ASSERT_TRUE(r->push(publicFrame(i % 4)));
  std::optional<View> view(std::in_place, *callers, publicCamera(), 1);
  std::optional<Fusion> fusion(std::in_place, *own);
  for (int n = 0; n < 4; ++n) {
    std::this_thread::sleep_for(std::chrono::milliseconds(7));  // the state is locked at times, or a frame is
    const auto refused = [](const auto& action) {
      try {
        action();
        return 0;
      } catch (const Error& error) {
        return int(error.kind() == Error::Kind::Misuse &&
                   std::string(error.what()).find("fork") != std::string::npos);
      }
    };
    EXPECT_EQ(childsEnd([&] {
                int in_words = 0;
                for (Reconstructor* r : {&*own, &*callers}) {
                  in_words += refused([&] { r->process(publicFrame(0)); });
                  in_words += refused([&] { r->integrate(publicFrame(0), kIdentity); });
                  in_words += refused([&] { r->push(publicFrame(0)); });
                  in_words += refused([&] { r->poll(); });
                  in_words += refused([&] { r->wait(); });
                  in_words += refused([&] { r->mesh(); });
                  in_words += refused([&] { r->trajectory(); });
                  in_words += refused([&] { r->blockCount(); });
                  in_words += refused([&] { View(*r, publicCamera(), 1); });
                  in_words += refused([&] { Fusion unused(*r); });
                }
                in_words += refused([&] { view->record(nullptr, 0, {}, {}); });
                in_words += refused([&] { fusion->grow(); });
                view.reset();
                fusion.reset();
                own = std::move(*callers);
                own.reset();
                callers.reset();
                return in_words;
              }),
              "exit code 22");
  }
  for (Reconstructor* r : {&*own, &*callers}) {
    r->wait();
    for (std::size_t i = 0; i < 16; ++i) EXPECT_NE(r->poll()->status, Status::Lost) << i;
  }
}

#ifndef __SANITIZE_THREAD__  // which lets no child of several threads begin one
TEST(Fork, TheChildMayMakeOneOfItsOwn) {
  Reconstructor reconstructor(publicCamera(), withAQueue());
  const Matrix expected = reconstructor.process(publicFrame(0)).world_from_camera;
  EXPECT_EQ(childsEnd([&] {
              Reconstructor own(publicCamera(), withAQueue());
              return own.process(publicFrame(0)).world_from_camera == expected ? 7 : 8;
            }),
            "exit code 7");
  EXPECT_NE(reconstructor.process(publicFrame(1)).status, Status::Lost);
}
#endif

}  // namespace test_processes
}  // namespace rosefusion::testing
