// Template files and their cache: what is read is what was written, and nothing damaged is believed.
#include "host/swarm/template_file.h"

#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <mutex>
#include <thread>

#include "host/core/error.h"

namespace rosefusion::testing {
namespace test_template_file {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

TemplateOptions small() {
  TemplateOptions options;
  options.sizes = {64, 32};
  options.count = 3;
  options.seed = 0xfedcba9876543210u;
  return options;
}

bool same(const TemplateSet& a, const TemplateSet& b) {
  if (a.options != b.options || a.levels.size() != b.levels.size()) return false;
  for (size_t level = 0; level < a.levels.size(); ++level)
    for (size_t i = 0; i < a.levels[level].size(); ++i)
      if (a.levels[level][i].particles != b.levels[level][i].particles ||
          a.levels[level][i].radius != b.levels[level][i].radius)
        return false;
  return true;
}

class TemplateFile : public ::testing::Test {
 protected:
  TemplateFile() {
    std::string pattern = (fs::temp_directory_path() / "rosefusion_swarm_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
    file_ = folder_ / "set.pst";
  }
  ~TemplateFile() override { fs::remove_all(folder_); }

  std::string bytes() const {
    std::ifstream in(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  void put(const std::string& content) const { std::ofstream(file_, std::ios::binary) << content; }

  std::string complaint() const {
    try {
      readTemplates(file_);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  fs::path folder_, file_;
};

TEST_F(TemplateFile, ReadsBackWhatWasWritten) {
  const TemplateSet set = generateTemplates(small());
  writeTemplates(file_, set);
  EXPECT_TRUE(same(readTemplates(file_), set));
}

// Fixed positions, so that a machine of the other byte order would notice.
TEST_F(TemplateFile, IsLittleEndian) {
  writeTemplates(file_, generateTemplates(small()));
  const std::string content = bytes();
  EXPECT_EQ(content.substr(0, 8), "ROSEPST\n");
  EXPECT_EQ(content.substr(8, 4), std::string("\1\0\0\0", 4));
  EXPECT_EQ(content.substr(12, 8), "\x10\x32\x54\x76\x98\xba\xdc\xfe");
  EXPECT_EQ(content.size(), 8 + 4 + 8 + 3 * 4 + 2 * 4 + 3 * (2 * 8 + (64 + 32) * 24) + 8u);
}

TEST_F(TemplateFile, RefusesEveryTruncation) {
  writeTemplates(file_, generateTemplates(small()));
  const std::string whole = bytes();
  for (const size_t length : {size_t{0}, size_t{5}, size_t{8}, size_t{11}, size_t{13}, size_t{30},
                              whole.size() / 2, whole.size() - 8, whole.size() - 1}) {
    put(whole.substr(0, length));
    EXPECT_THAT(complaint(), ::testing::AllOf(HasSubstr(file_.string()), HasSubstr("rosefusion pst --out")))
        << length;
  }
  put(whole + "x");
  EXPECT_THAT(complaint(), HasSubstr("checksum"));
}

TEST_F(TemplateFile, RefusesEveryFlippedByte) {
  TemplateOptions options = small();
  options.sizes = {32};
  options.count = 1;
  writeTemplates(file_, generateTemplates(options));
  const std::string whole = bytes();
  for (size_t i = 0; i < whole.size(); i += 7) {
    std::string damaged = whole;
    damaged[i] = static_cast<char>(damaged[i] ^ 0x40);
    put(damaged);
    EXPECT_NE(complaint(), "") << "byte " << i;
  }
}

TEST_F(TemplateFile, SaysWhatIsWrong) {
  EXPECT_THAT(complaint(), HasSubstr("no readable"));
  put("a text file, long enough to hold a header and a checksum");
  EXPECT_THAT(complaint(), HasSubstr("does not start like one"));
  writeTemplates(file_, generateTemplates(small()));
  std::string other = bytes();
  other[8] = 9;
  put(other);
  EXPECT_THAT(complaint(), HasSubstr("version 9"));
  fs::remove(file_);
  fs::create_directory(file_);
  EXPECT_THAT(complaint(), HasSubstr("no readable"));
}

// A file with a right checksum may still be wrong: made by a faulty or hostile program.
TEST_F(TemplateFile, RefusesAFileWhoseParticlesCannotBe) {
  TemplateSet set = generateTemplates(small());
  set.levels[1][2].particles[5][3] = 1.5f;
  writeTemplates(file_, set);
  EXPECT_THAT(complaint(), HasSubstr("outside the unit ball"));
  set.levels[1][2].particles[5][3] = NAN;
  writeTemplates(file_, set);
  EXPECT_THAT(complaint(), HasSubstr("outside the unit ball"));
  set = generateTemplates(small());
  std::swap(set.levels[0][0].particles[0], set.levels[0][0].particles[1]);
  writeTemplates(file_, set);
  EXPECT_THAT(complaint(), HasSubstr("zero move"));
  set = generateTemplates(small());
  set.options.sizes[0] = 65;
  writeTemplates(file_, set);
  EXPECT_THAT(complaint(), HasSubstr("do not fit"));
  set.options.sizes[0] = -1;
  writeTemplates(file_, set);
  EXPECT_THAT(complaint(), HasSubstr("size that cannot be"));
}

class TemplateCache : public TemplateFile {
 protected:
  // The set, counting in generated_ how many templates had to be made.
  TemplateSet load(const fs::path& file, const TemplateOptions& options = small()) {
    const auto count = [this](int, int) {
      const std::lock_guard lock(mutex_);
      ++generated_;
    };
    return loadOrGenerate(file, options, count, [this](Severity severity, const std::string& sentence) {
      EXPECT_EQ(severity, Severity::Warning);
      warnings_ += sentence;
    });
  }
  std::mutex mutex_;
  int generated_ = 0;
  std::string warnings_;
};

TEST_F(TemplateCache, GeneratesOnceAndThenReads) {
  const fs::path cache = folder_ / "made" / "for" / "it.pst";
  const TemplateSet first = load(cache);
  EXPECT_EQ(generated_, 6);
  EXPECT_TRUE(same(load(cache), first));
  EXPECT_EQ(generated_, 6);
  EXPECT_TRUE(same(readTemplates(cache), first));
}

TEST_F(TemplateCache, RebuildsACorruptFileWithAWarning) {
  const TemplateSet first = load(file_);
  put(bytes().substr(0, 1000));
  const TemplateSet again = load(file_);
  EXPECT_THAT(warnings_, HasSubstr(file_.string()));
  EXPECT_EQ(generated_, 12);
  EXPECT_TRUE(same(again, first));
  EXPECT_TRUE(same(readTemplates(file_), first));
}

TEST_F(TemplateCache, RebuildsAFileOfOtherOptions) {
  load(file_);
  TemplateOptions other = small();
  other.seed = 4;
  EXPECT_EQ(load(file_, other).options, other);
  EXPECT_EQ(generated_, 12);
}

TEST_F(TemplateCache, WorksWithoutAPlaceToWrite) {
  put("a file where a folder is needed");
  const TemplateSet set = load(file_ / "cache.pst");
  EXPECT_THAT(warnings_, HasSubstr("generated again next time"));
  EXPECT_TRUE(same(set, generateTemplates(small())));
  EXPECT_TRUE(same(load({}), set));
}

TEST_F(TemplateCache, LetsOnlyOneOfManyGenerate) {
  std::vector<TemplateSet> sets(6);
  {
    std::vector<std::jthread> others;
    for (TemplateSet& set : sets) others.emplace_back([&] { set = load(file_); });
  }
  EXPECT_EQ(generated_, 6);
  for (const TemplateSet& set : sets) EXPECT_TRUE(same(set, sets[0]));
}

TEST(DefaultTemplateCache, FollowsTheXdgSpecification) {
  const auto restore = [](const char* name) {
    const char* value = std::getenv(name);
    return std::pair<std::string, bool>(value ? value : "", value != nullptr);
  };
  const auto home = restore("HOME"), xdg = restore("XDG_CACHE_HOME");
  const auto set = [](const char* name, const char* value) {
    value ? setenv(name, value, 1) : unsetenv(name);
  };

  set("HOME", "/home/someone");
  set("XDG_CACHE_HOME", "/var/my cache");
  EXPECT_EQ(defaultTemplateCache({}).parent_path(), "/var/my cache/rosefusion");
  set("XDG_CACHE_HOME", nullptr);
  EXPECT_EQ(defaultTemplateCache({}).parent_path(), "/home/someone/.cache/rosefusion");
  set("XDG_CACHE_HOME", "relative");
  EXPECT_EQ(defaultTemplateCache({}).parent_path(), "/home/someone/.cache/rosefusion");
  EXPECT_NE(defaultTemplateCache({}), defaultTemplateCache(small()));
  set("HOME", nullptr);
  EXPECT_TRUE(defaultTemplateCache({}).empty());

  set("HOME", home.second ? home.first.c_str() : nullptr);
  set("XDG_CACHE_HOME", xdg.second ? xdg.first.c_str() : nullptr);
}

}  // namespace test_template_file
}  // namespace rosefusion::testing
