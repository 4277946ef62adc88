#include <cpl_error.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "hydrotin/error.h"
#include "hydrotin/las.h"
#include "las_decoding.h"
#include "las_good_files.h"
#include "las_header.h"
#include "las_memory_file.h"
#include "laz_chunk_table.h"

// Every good file, cut and with flipped bytes: each ends in an Error or in a result, which is right wherever one can
// know what is right. In a build with sanitizers every wrong step on the way is found.

#if defined(__SANITIZE_ADDRESS__)
// A larger allocation ends the test: no file here has chunks that need a tenth of it. Who allocated is not kept: stacks
// through libraries without frame pointers never repeat, and remembering them takes all the time and memory there is.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
  return "max_allocation_size_mb=256:malloc_context_size=1";
}
#endif

namespace hydrotin {
namespace {

using testing::Bytes;
using testing::DamagedFile;
using testing::kAllFields;
using testing::MemoryFile;
using testing::peek;
using testing::poke;
using testing::read_bytes;

constexpr std::size_t kCuts = 200, kDamages = 1000;
constexpr std::size_t kSmall = 100'000;  // bytes of a file that takes no time at all

void expect_clear(const Error& error, const std::string& path) {
  EXPECT_EQ(error.kind(), ErrorKind::input);
  EXPECT_EQ(std::string(error.what()).find(path), 0U) << error.what();
}

std::optional<LasFile> open(const DamagedFile& damaged) {
  try {
    return LasFile(damaged.path());
  } catch (const Error& error) {
    expect_clear(error, damaged.path());
    return std::nullopt;
  }
}

// One chunk in each of the two ways, or one of them.
struct Decoded {
  PointBatch batch;
  std::vector<std::byte> records;
};
enum class Way { batch, records, both };

bool decode(const LasFile& file, std::size_t chunk, Way way, Decoded& out) {
  try {
    if (way != Way::records) {
      file.decode(chunk, out.batch, kAllFields);
      EXPECT_EQ(out.batch.size(), file.chunk_point_count(chunk));
      EXPECT_EQ(out.batch.flags.size(), out.batch.size());
    }
    if (way != Way::batch) {
      file.decode_records(chunk, out.records);
      EXPECT_EQ(out.records.size(), file.chunk_point_count(chunk) * file.header().record_length);
    }
    return true;
  } catch (const Error& error) {
    expect_clear(error, file.path());
    return false;
  }
}

// Everything a reader does with a file. Returns whether it was complete.
bool use(const Bytes& bytes) {
  const MemoryFile memory("hydrotin_damaged.laz", bytes);
  try {
    const LasFile file(memory.path());
    Decoded decoded;
    for (std::size_t i = 0; i < file.num_chunks(); ++i)
      if (!decode(file, i, Way::both, decoded)) return false;
  } catch (const Error& error) {
    expect_clear(error, memory.path());
    return false;
  }
  return true;
}

std::size_t points_that_differ(const PointBatch& a, const PointBatch& b) {
  if (a.size() != b.size()) return std::max(a.size(), b.size());
  std::size_t count = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    count += a.x[i] != b.x[i] || a.y[i] != b.y[i] || a.z[i] != b.z[i] || a.classification[i] != b.classification[i] ||
             a.flags[i] != b.flags[i] || a.return_number[i] != b.return_number[i] ||
             a.number_of_returns[i] != b.number_of_returns[i];
  return count;
}

// A sound file, all that it decodes to, and where its parts are.
struct SoundFile {
  explicit SoundFile(const std::string& name) : bytes(read_bytes(testing::shared_path(name))) {
    const LasFile file(testing::shared_path(name));
    header = file.header();
    chunk.resize(file.num_chunks());
    for (std::size_t i = 0; i < chunk.size(); ++i) EXPECT_TRUE(decode(file, i, Way::both, chunk[i]));
    for (std::size_t i = 0; i <= chunk.size(); ++i) first_point.push_back(file.chunk_first_point(i));
    if (!header.compressed) {
      for (const std::uint64_t point : first_point)
        begin.push_back(header.offset_to_points + point * header.record_length);
    } else if (header.sequential) {  // one stream: the chunks' places in it are not known
      begin = {header.offset_to_points, bytes.size()};
    } else {
      const LasSource source(testing::shared_path(name));
      const LazLayout layout = parse_laszip(parse_las(source).laszip, header, name);
      const std::vector<LazChunk> table = read_chunk_table(source, header, layout).value();
      for (const LazChunk& c : table) begin.push_back(c.begin);
    }
  }

  [[nodiscard]] std::size_t num_spans() const { return begin.size() - 1; }
  [[nodiscard]] bool is_in_points(std::size_t at) const { return at >= begin.front() && at < begin.back(); }
  [[nodiscard]] std::size_t span_of(std::size_t at) const {
    return static_cast<std::size_t>(std::upper_bound(begin.begin(), begin.end(), at) - begin.begin()) - 1;
  }
  // Whether another file has its points in the same chunks.
  [[nodiscard]] bool is_laid_out_like(const LasFile& file) const {
    const LasHeader& h = file.header();
    if (h.compressed != header.compressed || h.sequential != header.sequential ||
        h.point_format != header.point_format || h.record_length != header.record_length ||
        h.offset_to_points != header.offset_to_points || file.num_chunks() != chunk.size())
      return false;
    for (std::size_t i = 0; i < first_point.size(); ++i)
      if (file.chunk_first_point(i) != first_point[i]) return false;
    return true;
  }

  Bytes bytes;
  LasHeader header;
  std::vector<Decoded> chunk;
  std::vector<std::uint64_t> first_point;  // [chunks + 1]
  std::vector<std::uint64_t> begin;        // [spans + 1] bytes; a span is a chunk, or the whole of a stream
};

void expect_sound(const Decoded& got, const Decoded& sound, Way way, std::size_t chunk) {
  if (way != Way::records) {
    EXPECT_EQ(points_that_differ(got.batch, sound.batch), 0U) << "sound chunk " << chunk;
  }
  if (way != Way::batch) {
    EXPECT_TRUE(got.records == sound.records) << "sound chunk " << chunk;
  }
}

// Records of a plain file are the bytes of the file, damaged or not.
void expect_bytes(const LasFile& file, const DamagedFile& damaged, std::size_t chunk, const Decoded& got) {
  const std::uint64_t at = file.header().offset_to_points + file.chunk_first_point(chunk) * file.header().record_length;
  ASSERT_LE(at + got.records.size(), damaged.size());
  EXPECT_EQ(std::memcmp(got.records.data(), damaged.bytes().data() + at, got.records.size()), 0) << "chunk " << chunk;
}

// Where damage goes: half of it where it hurts most, in front of and behind the points or at the head of a chunk.
std::size_t place_of_damage(const SoundFile& sound, std::mt19937& random) {
  const std::size_t size = sound.bytes.size(), behind = size - sound.begin.back();
  switch (random() % 12) {
    case 0:
    case 1:
    case 2:  // header and VLRs
      return random() % std::min<std::size_t>(size, sound.begin.front());
    case 3:
    case 4:  // behind the points: chunk table, EVLRs
      return behind == 0 ? random() % size : size - 1 - random() % behind;
    case 5: {  // a chunk's first record, and how long its layers are or where its stream begins
      const std::size_t span = random() % sound.num_spans();
      return std::min<std::size_t>(sound.begin[span] + random() % (sound.header.record_length + 48U), size - 1);
    }
    default:
      return random() % size;
  }
}

std::uint8_t any_bits(std::mt19937& random) {
  return static_cast<std::uint8_t>(1 + random() % 255);
}

// Damage outside the points: the file is refused, or its points are those that it now declares.
void use_damaged_frame(const SoundFile& sound, const DamagedFile& damaged, const std::vector<std::size_t>& places,
                       bool thorough) {
  const auto file = open(damaged);
  if (!file) return;
  const std::size_t num = file->num_chunks();
  if (num == 0) return;
  // What lies before the points, the laszip record apart, does not say how they are decoded.
  const std::string tag = "laszip encoded";
  const auto vlr = std::search(sound.bytes.begin(), sound.bytes.end(), tag.begin(), tag.end()) - sound.bytes.begin();
  const auto laszip = static_cast<std::size_t>(vlr) - 2;
  const bool says_how = std::any_of(places.begin(), places.end(), [&](std::size_t at) {
    return at >= sound.header.offset_to_points || (at >= laszip && at < laszip + 54 + 34 + 6 * 5);
  });
  const bool is_right = sound.is_laid_out_like(*file) && !says_how;
  std::vector<std::size_t> tried;
  if (thorough) {
    tried = {0, num - 1};
  } else {
    std::size_t least = 0;
    for (std::size_t i = 1; i < num; ++i)
      if (file->chunk_point_count(i) < file->chunk_point_count(least)) least = i;
    tried = {least};
  }
  Decoded got;
  for (const std::size_t chunk : tried) {
    const bool ok = decode(*file, chunk, Way::both, got);
    if (is_right) {
      EXPECT_TRUE(ok) << "sound chunk " << chunk;
      if (ok) expect_sound(got, sound.chunk[chunk], Way::both, chunk);
    }
    if (!file->header().compressed) {
      EXPECT_TRUE(ok) << "chunk " << chunk;
      if (ok) expect_bytes(*file, damaged, chunk, got);
    }
  }
}

// Damage to the points in some spans: those spans are refused or have their number of points, all others are right.
void use_damaged_spans(const SoundFile& sound, const DamagedFile& damaged, const std::vector<std::size_t>& flips_in,
                       std::size_t also, Way way) {
  const auto file = open(damaged);
  ASSERT_TRUE(file && sound.is_laid_out_like(*file)) << "the points say nothing about the layout";
  Decoded got;
  if (sound.header.sequential) {
    for (std::size_t i = 0; i < file->num_chunks(); ++i)
      if (!decode(*file, i, way, got)) return;
    return;
  }
  for (std::size_t i = 0; i < file->num_chunks(); ++i) {
    if (flips_in[i] == 0 && i != also) continue;
    const bool ok = decode(*file, i, way, got);
    if (flips_in[i] == 0) {
      EXPECT_TRUE(ok) << "sound chunk " << i;
      if (ok) expect_sound(got, sound.chunk[i], way, i);
    } else if (!sound.header.compressed) {
      EXPECT_TRUE(ok) << "chunk " << i;
      if (ok && way != Way::batch) expect_bytes(*file, damaged, i, got);
      if (ok && way != Way::records) {
        EXPECT_LE(points_that_differ(got.batch, sound.chunk[i].batch), flips_in[i]) << "chunk " << i;
      }
    }
  }
}

// GDAL says on stderr what we say in Errors.
class Quiet : public ::testing::Environment {
 public:
  void SetUp() override { CPLPushErrorHandler(CPLQuietErrorHandler); }
  void TearDown() override { CPLPopErrorHandler(); }
};
const auto* const kQuiet = ::testing::AddGlobalTestEnvironment(new Quiet);

// A file, or a share of the damages of one that is slow to decode: a stream without chunks.
struct Share {
  std::string file;
  std::size_t part, parts;
};

void PrintTo(const Share& share, std::ostream* out) {
  *out << share.file << ", part " << share.part + 1 << " of " << share.parts;
}

std::vector<Share> shares() {
  std::vector<Share> out;
  for (const std::string& file : testing::good_las_files()) {
    const std::size_t parts = testing::laz_compressor(file) == 1 ? 8 : 1;
    for (std::size_t part = 0; part < parts; ++part) out.push_back({file, part, parts});
  }
  if (out.empty()) out.push_back({"no shared data", 0, 1});
  return out;
}

std::string name_of(const ::testing::TestParamInfo<Share>& info) {
  const auto& [file, part, parts] = info.param;
  return testing::test_name_of(file) + (parts > 1 ? "_part_" + std::to_string(part + 1) : "");
}

class LasRobustness : public ::testing::TestWithParam<Share> {};

INSTANTIATE_TEST_SUITE_P(All, LasRobustness, ::testing::ValuesIn(shares()), name_of);

// A cut file is refused, or all its points are there and right: what was cut off was no point.
TEST_P(LasRobustness, CutAnywhere) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const auto& [name, part, parts] = GetParam();
  const SoundFile sound(name);
  DamagedFile damaged("hydrotin_cut.laz", sound.bytes);
  std::mt19937 random(1848);
  for (std::size_t i = 0; i < kCuts; ++i) {
    const std::size_t step = std::max<std::size_t>(1, sound.bytes.size() / kCuts);
    const std::size_t length = std::min(sound.bytes.size() * i / kCuts + random() % step, sound.bytes.size() - 1);
    if (i % parts != part) continue;
    SCOPED_TRACE("cut at " + std::to_string(length));
    damaged.cut(length);
    if (const auto file = open(damaged)) {
      EXPECT_TRUE(sound.is_laid_out_like(*file));
      Decoded got;
      bool complete = true;
      for (std::size_t c = 0; complete && c < std::min(file->num_chunks(), sound.chunk.size()); ++c) {
        const Way way = sound.header.sequential ? Way::batch : Way::both;
        complete = decode(*file, c, way, got);
        if (complete) expect_sound(got, sound.chunk[c], way, c);
      }
      if (complete && !sound.header.sequential) {
        EXPECT_GE(length, sound.begin.back()) << "points are missing, but nobody says so";
      }
    }
    damaged.mend();
  }
}

TEST_P(LasRobustness, BytesFlippedAnywhere) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  const auto& [name, part, parts] = GetParam();
  const SoundFile sound(name);
  DamagedFile damaged("hydrotin_flipped.laz", sound.bytes);
  std::mt19937 random(20240607);
  std::vector<std::vector<std::pair<std::size_t, std::uint8_t>>> in_span(sound.num_spans());
  for (std::size_t i = 0; i < kDamages; ++i) {
    const std::size_t at = place_of_damage(sound, random);
    const std::uint8_t bits = any_bits(random);
    const std::size_t second = place_of_damage(sound, random);
    if (i % parts != part) continue;
    if (sound.is_in_points(at)) {
      in_span[sound.span_of(at)].emplace_back(at, bits);
      continue;
    }
    SCOPED_TRACE("damage " + std::to_string(i) + " to byte " + std::to_string(at));
    std::vector<std::size_t> places{at};
    if (i % 4 == 3 && !sound.is_in_points(second)) places.push_back(second);  // two lies may fit together
    for (const std::size_t place : places) damaged.flip(place, bits);
    use_damaged_frame(sound, damaged, places, i % 8 == 0);
    damaged.mend();
  }
  // Chunks know nothing of each other: one damage to each of them in one copy of the file.
  std::size_t round = 0;
  for (bool any = true; any; ++round) {
    any = false;
    std::vector<std::size_t> flips_in(sound.num_spans(), 0);
    std::string places;
    for (std::size_t s = 0; s < in_span.size(); ++s) {
      if (in_span[s].empty() || (in_span.size() > 1 && s == round % std::max<std::size_t>(in_span.size(), 4))) {
        any = any || !in_span[s].empty();
        continue;
      }
      any = true;
      damaged.flip(in_span[s].back().first, in_span[s].back().second);
      places += " " + std::to_string(in_span[s].back().first);
      in_span[s].pop_back();
      flips_in[s] = 1;
    }
    SCOPED_TRACE("damage to bytes" + places);
    const Way way = sound.bytes.size() < kSmall ? Way::both : round % 2 == 0 ? Way::batch : Way::records;
    use_damaged_spans(sound, damaged, flips_in, round % std::max<std::size_t>(in_span.size(), 4), way);
    damaged.mend();
  }
}

// Small LAZ files, which together need every codec: what follows decodes them from one end to the other.
std::vector<std::string> small_laz_files() {
  std::vector<std::string> out;
  for (const std::string& file : testing::good_las_files()) {
    if (testing::laz_compressor(file) > 1 && std::filesystem::file_size(testing::shared_path(file)) < kSmall)
      out.push_back(file);
  }
  if (out.empty()) out.emplace_back("no shared data");
  return out;
}

class LasRobustnessWithoutTable : public ::testing::TestWithParam<std::string> {};

INSTANTIATE_TEST_SUITE_P(All, LasRobustnessWithoutTable, ::testing::ValuesIn(small_laz_files()),
                         [](const auto& file) { return testing::test_name_of(file.param); });

// Streams and layered files in which chunks are found by decoding or walking.
TEST_P(LasRobustnessWithoutTable, CutAndFlipped) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  Bytes sound = read_bytes(testing::shared_path(GetParam()));
  const std::size_t at = peek<std::uint32_t>(sound, 96);
  sound.resize(static_cast<std::size_t>(peek<std::uint64_t>(sound, at)));
  poke(sound, at, std::uint64_t{at});
  EXPECT_TRUE(use(sound));
  std::mt19937 random(4711);
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE("damage " + std::to_string(i));
    Bytes bytes = sound;
    bytes[at + 8 + random() % (bytes.size() - at - 8)] ^= static_cast<std::uint8_t>(1 + random() % 255);
    if (i % 4 == 0) bytes.resize(at + random() % (bytes.size() - at));
    use(bytes);
  }
}

// A header may claim anything: memory follows what is really there.
TEST(LasRobustnessClaims, HugeCountsTakeNoMemory) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  for (const char* name : {"pairs/point-time.laz", "pairs/pdrf6-1.4.laz"}) {
    Bytes bytes = read_bytes(testing::shared_path(name));
    const bool is_14 = bytes[25] >= 4;
    // One chunk that claims four thousand million points.
    if (is_14) {
      poke(bytes, 247, std::uint64_t{4'000'000'000U});
    } else {
      poke(bytes, 107, std::uint32_t{4'000'000'000U});
    }
    const std::string tag = "laszip encoded";
    const auto vlr = std::search(bytes.begin(), bytes.end(), tag.begin(), tag.end()) - bytes.begin();
    poke(bytes, static_cast<std::size_t>(vlr) - 2 + 54 + 12, std::uint32_t{4'000'000'000U});
    poke(bytes, static_cast<std::size_t>(peek<std::uint64_t>(bytes, peek<std::uint32_t>(bytes, 96))) + 4,
         std::uint32_t{1});
    EXPECT_FALSE(use(bytes)) << name;
  }
}

TEST(LasRobustnessClaims, PointwiseStreamWithoutChunks) {
  HYDROTIN_REQUIRE_SHARED_DATA();
  Bytes sound = read_bytes(testing::shared_path("formats/TO_core_last_zoom.laz"));
  sound.resize(40'000);
  poke(sound, 107, std::uint32_t{12'000});
  ASSERT_TRUE(use(sound)) << "12,000 points are in the first 40,000 bytes";
  std::mt19937 random(99);
  for (int i = 0; i < 200; ++i) {
    SCOPED_TRACE("damage " + std::to_string(i));
    Bytes bytes = sound;
    bytes[random() % bytes.size()] ^= static_cast<std::uint8_t>(1 + random() % 255);
    if (i % 4 == 0) bytes.resize(random() % bytes.size());
    use(bytes);
  }
}

}  // namespace
}  // namespace hydrotin
