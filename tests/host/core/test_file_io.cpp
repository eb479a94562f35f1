#include "host/core/file_io.h"

#include <gmock/gmock.h>

#include <sys/resource.h>
#include <csignal>

#include "tests/host/core/temporary_folder.h"

namespace rosefusion::testing {
namespace test_file_io {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(WriteFileAtomically, WritesEveryByteAndLeavesNothingElse) {
  const TemporaryFolder folder;
  const std::string bytes("a\0b\r\n\xff", 6);
  writeFileAtomically(folder / "file.bin", bytes);
  EXPECT_EQ(contents(folder / "file.bin"), bytes);
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(WriteFileAtomically, MakesMissingFoldersAndReplacesOldFiles) {
  const TemporaryFolder folder;
  const fs::path file = folder / "a" / "b" / "file.txt";
  writeFileAtomically(file, "the old and longer text");
  writeFileAtomically(file, "new");
  EXPECT_EQ(contents(file), "new");
}

TEST(WriteFileAtomically, WritesAnEmptyFile) {
  const TemporaryFolder folder;
  writeFileAtomically(folder / "empty", "");
  EXPECT_TRUE(fs::exists(folder / "empty"));
  EXPECT_EQ(fs::file_size(folder / "empty"), 0u);
}

TEST(WriteFileAtomically, NamesTheFolderThatCannotBeMade) {
  const TemporaryFolder folder;
  const fs::path not_a_folder = folder.write("plain", "x");
  const std::string sentence = inputErrorOf([&] { writeFileAtomically(not_a_folder / "sub" / "file", "x"); });
  EXPECT_THAT(sentence, AllOf(StartsWith((not_a_folder / "sub").string()), HasSubstr("Not a directory"),
                              HasSubstr("choose another output folder")));
  EXPECT_EQ(contents(not_a_folder), "x");
}

TEST(WriteFileAtomically, NamesAFileWhoseNameIsTooLong) {
  const TemporaryFolder folder;
  const fs::path file = folder / std::string(300, 'n');
  const std::string sentence = inputErrorOf([&] { writeFileAtomically(file, "x"); });
  EXPECT_THAT(sentence, AllOf(StartsWith(file.string()), HasSubstr("File name too long")));
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(WriteFileAtomically, DoesNotReplaceAFolder) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "taken");
  const std::string sentence = inputErrorOf([&] { writeFileAtomically(folder / "taken", "x"); });
  EXPECT_THAT(sentence, AllOf(StartsWith((folder / "taken").string()), HasSubstr("Is a directory")));
  EXPECT_TRUE(fs::is_directory(folder / "taken"));
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(WriteFileAtomically, ReplacesALinksTargetAndWritesToADevice) {
  const TemporaryFolder folder;
  const fs::path target = folder.write("target", "old");
  fs::create_symlink(target, folder / "link");
  writeFileAtomically(folder / "link", "new");
  EXPECT_TRUE(fs::is_symlink(folder / "link"));
  EXPECT_EQ(contents(target), "new");
  fs::create_symlink("/dev/null", folder / "null");
  writeFileAtomically(folder / "null", "gone");
  EXPECT_TRUE(fs::is_symlink(folder / "null"));
  EXPECT_TRUE(fs::is_character_file(folder / "null"));
  EXPECT_EQ(folder.entries(), 3u);
}

TEST(ReadFile, GivesAllBytesOrSaysWhyNot) {
  const TemporaryFolder folder;
  const std::string bytes = std::string(1 << 17, 'x') + std::string("\0\r\n", 3);
  EXPECT_EQ(readFile(folder.write("file", bytes)), bytes);
  EXPECT_THAT(inputErrorOf([&] { readFile(folder / "absent"); }), HasSubstr("No such file"));
  EXPECT_THAT(inputErrorOf([&] { readFile(folder.path()); }), HasSubstr("Is a directory"));
  // A disk that fails halfway.
  if (fs::exists("/proc/self/mem")) {
    EXPECT_THAT(inputErrorOf([] { readFile("/proc/self/mem"); }), HasSubstr("Input/output error"));
  }
}

TEST(RequireWritable, TellsEarlyAndChangesNothing) {
  const TemporaryFolder folder;
  const fs::path file = folder.write("plain", "x");
  requireWritable(file);
  EXPECT_EQ(contents(file), "x");
  requireWritable(folder / "not yet");
  EXPECT_EQ(folder.entries(), 1u);
  EXPECT_THAT(inputErrorOf([&] { requireWritable(file / "below"); }), HasSubstr("Not a directory"));
  EXPECT_THAT(inputErrorOf([&] { requireWritable(folder.path()); }), HasSubstr("Is a directory"));
}

TEST(WriteFileAtomically, FullDiskKeepsTheOldFileWhole) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "this system has no /dev/full";
  const TemporaryFolder folder;
  const fs::path file = folder.write("result", "old");
  fs::create_symlink("/dev/full", folder / "result.part");  // the name of the temporary file
  const std::string sentence = inputErrorOf([&] { writeFileAtomically(file, "new"); });
  EXPECT_THAT(sentence, AllOf(StartsWith(file.string()), HasSubstr("No space left on device"),
                              HasSubstr("free some space or choose another output folder")));
  EXPECT_EQ(contents(file), "old");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(WriteFileAtomically, DiskThatFillsUpHalfwayLeavesNoFile) {
  const TemporaryFolder folder;
  rlimit unlimited{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &unlimited), 0);
  const rlimit limited{4096, unlimited.rlim_max};
  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limited), 0);
  const std::string sentence =
      inputErrorOf([&] { writeFileAtomically(folder / "big", std::string(1 << 20, 'x')); });
  setrlimit(RLIMIT_FSIZE, &unlimited);
  std::signal(SIGXFSZ, old_handler);
  EXPECT_THAT(sentence, AllOf(StartsWith((folder / "big").string()), HasSubstr("File too large")));
  EXPECT_EQ(folder.entries(), 0u);
}

}  // namespace test_file_io
}  // namespace rosefusion::testing
