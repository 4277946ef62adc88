#include <algorithm>
#include <cassert>
#include <mutex>

#include "hydrotin/error.h"
#include "hydrotin/las.h"
#include "las_header.h"
#include "las_record.h"
#include "las_source.h"
#include "laz_chunk_table.h"
#include "laz_layered.h"
#include "laz_layout.h"
#include "laz_pointwise.h"
#include "laz_sequential.h"

namespace hydrotin {
namespace {

constexpr std::uint64_t kPlainChunk = 65536;    // points
constexpr std::uint64_t kGrowth = 65536;        // points for which memory is taken before they are decoded,
constexpr std::size_t kGrowthBytes = 4 << 20;   // or fewer, where the records are long
constexpr std::size_t kBlockBytes = 16 * 1024;  // records on their way into a batch

// Objects that are costly to make, borrowed by one thread at a time.
template <class T>
class Pool {
 public:
  template <class Make>
  std::unique_ptr<T> borrow(Make make) {
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        auto object = std::move(idle_.back());
        idle_.pop_back();
        return object;
      }
    }
    return make();
  }
  void give_back(std::unique_ptr<T> object) {
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(object));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<T>> idle_;
};

// Takes records in blocks and puts them where they belong.
class BatchSink {
 public:
  BatchSink(PointBatch& batch, PointFields fields, const LasHeader& header)
      : batch_(batch), fields_(fields), record_length_(header.record_length), format_14_(header.point_format >= 6) {
    buffer_.resize(block() * record_length_);
  }
  [[nodiscard]] std::size_t block() const { return std::max<std::size_t>(1, kBlockBytes / record_length_); }
  [[nodiscard]] std::uint64_t growth() const { return kGrowth; }
  void expect(std::uint64_t points) { resize(batch_, static_cast<std::size_t>(points), fields_); }
  std::uint8_t* room(std::size_t /*first*/) { return buffer_.data(); }
  void done(std::size_t first, std::size_t count) {
    unpack_records(buffer_.data(), count, record_length_, format_14_, fields_, batch_, first);
  }
  [[nodiscard]] PointFields fields() const { return fields_; }
  [[nodiscard]] bool whole_records() const { return false; }

 private:
  PointBatch& batch_;
  PointFields fields_;
  std::size_t record_length_;
  bool format_14_;
  std::vector<std::uint8_t> buffer_;
};

class RecordSink {
 public:
  RecordSink(std::vector<std::byte>& records, const LasHeader& header)
      : records_(records), record_length_(header.record_length) {}
  [[nodiscard]] std::size_t block() const { return std::min<std::size_t>(4096, growth()); }
  [[nodiscard]] std::uint64_t growth() const {
    return std::clamp<std::uint64_t>(kGrowthBytes / record_length_, 1, kGrowth);
  }
  void expect(std::uint64_t points) { records_.resize(static_cast<std::size_t>(points) * record_length_); }
  std::uint8_t* room(std::size_t first) {
    return reinterpret_cast<std::uint8_t*>(records_.data()) + first * record_length_;
  }
  void done(std::size_t /*first*/, std::size_t /*count*/) {}
  [[nodiscard]] PointFields fields() const { return {}; }
  [[nodiscard]] bool whole_records() const { return true; }

 private:
  std::vector<std::byte>& records_;
  std::size_t record_length_;
};

// Hands `count` points from `read(count, to)` to the sink. Memory grows with what was really decoded.
template <class Sink, class Read>
bool pour(std::uint64_t count, Sink& sink, Read read) {
  std::uint64_t first = 0, room = 0;
  sink.expect(0);
  while (first < count) {
    if (first == room) {
      room = std::min(count, room + std::max(sink.growth(), room / 2));
      sink.expect(room);
    }
    const auto block = static_cast<std::size_t>(std::min<std::uint64_t>(sink.block(), room - first));
    if (!read(block, sink.room(static_cast<std::size_t>(first)))) return false;
    sink.done(static_cast<std::size_t>(first), block);
    first += block;
  }
  return true;
}

}  // namespace

struct LasFile::Impl {
  explicit Impl(std::string path) : source(std::move(path)) {}

  LasSource source;
  LasHeader header;
  LazLayout layout;
  std::vector<LazChunk> chunks;               // and their end; empty when plain or sequential
  std::unique_ptr<LazSequential> sequential;  // without chunk table
  std::uint64_t chunk_points = kPlainChunk;   // of every chunk but the last, when plain or sequential
  mutable Pool<PointwiseDecoder> pointwise;
  mutable Pool<LayeredDecoder> layered;
  mutable Pool<std::vector<std::uint8_t>> buffers;

  void open();
  void check_plain();
  [[noreturn]] void fail_chunk(std::size_t chunk) const;
  [[nodiscard]] std::uint64_t first_point(std::size_t chunk) const;
  template <class Sink>
  void decode(std::size_t chunk, Sink& sink) const;
  template <class Sink>
  bool decode_laz(std::size_t chunk, std::uint64_t count, Sink& sink) const;
};

void LasFile::Impl::open() {
  ParsedLas parsed = parse_las(source);
  header = std::move(parsed.header);
  if (!header.compressed) {
    check_plain();
    return;
  }
  layout = parse_laszip(parsed.laszip, header, source.path());
  if (auto table = read_chunk_table(source, header, layout)) {
    chunks = std::move(*table);
    return;
  }
  header.sequential = true;
  const bool chunked = layout.chunk_size != kVariableChunks;
  if (chunked) chunk_points = layout.chunk_size;
  const std::uint64_t begin = header.offset_to_points + (chunked ? 8 : 0);
  sequential = std::make_unique<LazSequential>(source, layout, begin, chunked ? chunk_points : header.point_count);
}

void LasFile::Impl::check_plain() {
  const std::uint64_t present = (source.size() - header.offset_to_points) / header.record_length;
  if (present < header.point_count)
    throw Error(ErrorKind::input, source.path() + ": declares " + std::to_string(header.point_count) +
                                      " points, but only " + std::to_string(present) +
                                      " are there: the file was cut off (get it again)");
  // LAS 1.3 may keep waveforms behind the points, LAS 1.4 extended records.
  if (present > header.point_count && header.version_minor != 3 && header.num_evlrs == 0)
    header.warnings.push_back("declares " + std::to_string(header.point_count) + " points, but has room for " +
                              std::to_string(present) + ": was its writer interrupted?");
}

void LasFile::Impl::fail_chunk(std::size_t chunk) const {
  const std::uint64_t first = first_point(chunk);
  throw Error(ErrorKind::input, source.path() + ": the compressed points " + std::to_string(first) + " to " +
                                    std::to_string(first_point(chunk + 1) - 1) +
                                    " are damaged or cut off (get the file again)");
}

std::uint64_t LasFile::Impl::first_point(std::size_t chunk) const {
  if (!chunks.empty()) return chunks[chunk].first_point;
  const std::uint64_t whole = header.point_count / chunk_points;
  return chunk <= whole ? chunk * chunk_points : header.point_count;
}

template <class Sink>
bool LasFile::Impl::decode_laz(std::size_t chunk, std::uint64_t count, Sink& sink) const {
  const bool is_layered = layout.compressor == LazCompressor::layered_chunked;
  const std::uint64_t begin = chunks[chunk].begin;
  const auto bytes = static_cast<std::size_t>(chunks[chunk + 1].begin - begin);
  auto buffer = buffers.borrow([] { return std::make_unique<std::vector<std::uint8_t>>(); });
  const std::size_t padding = is_layered ? LayeredDecoder::kPadding : PointwiseDecoder::padding(header.record_length);
  buffer->resize(bytes + padding);
  const std::size_t head = is_layered && !sink.whole_records() ? LayeredDecoder::head_bytes(layout) : 0;
  if (head > 0 && head < bytes) {  // of layers that nobody wants, not a byte is read
    source.read(begin, buffer->data(), head);
    const std::uint64_t front = std::min<std::uint64_t>(bytes, LayeredDecoder::front_bytes(layout, buffer->data()));
    source.read(begin + head, buffer->data() + head, static_cast<std::size_t>(front) - head);
  } else {
    source.read(begin, buffer->data(), bytes);
  }
  std::memset(buffer->data() + bytes, 0, padding);
  const std::uint8_t* const data = buffer->data();
  bool ok = false;
  if (is_layered) {
    auto decoder = layered.borrow([&] { return std::make_unique<LayeredDecoder>(layout); });
    ok = decoder->start(data, data + bytes, count, sink.fields(), sink.whole_records()) &&
         pour(count, sink, [&](std::size_t n, std::uint8_t* to) { return decoder->read(n, to); });
    layered.give_back(std::move(decoder));
  } else {
    auto decoder = pointwise.borrow([&] { return std::make_unique<PointwiseDecoder>(layout); });
    // A stream that does not end where the next chunk begins was not decoded as it was written.
    ok = decoder->start(data, data + bytes) &&
         pour(count, sink, [&](std::size_t n, std::uint8_t* to) { return decoder->read(n, to); }) &&
         decoder->next() == data + bytes;
    pointwise.give_back(std::move(decoder));
  }
  buffers.give_back(std::move(buffer));
  return ok;
}

template <class Sink>
void LasFile::Impl::decode(std::size_t chunk, Sink& sink) const {
  const std::uint64_t first = first_point(chunk), count = first_point(chunk + 1) - first;
  const std::size_t length = header.record_length;
  bool ok = true;
  if (!header.compressed) {
    std::uint64_t at = header.offset_to_points + first * length;
    ok = pour(count, sink, [&](std::size_t n, std::uint8_t* to) {
      source.read(at, to, n * length);
      at += n * length;
      return true;
    });
  } else if (sequential != nullptr) {
    const LazSequential::Turn turn = sequential->seek(first);
    ok = pour(count, sink, [&](std::size_t n, std::uint8_t* to) { return sequential->read(n, to); });
  } else {
    ok = decode_laz(chunk, count, sink);
  }
  if (!ok) fail_chunk(chunk);
}

LasFile::LasFile(std::string path) : impl_(std::make_unique<Impl>(std::move(path))) {
  impl_->open();
}
LasFile::LasFile(LasFile&&) noexcept = default;
LasFile& LasFile::operator=(LasFile&&) noexcept = default;
LasFile::~LasFile() = default;

const std::string& LasFile::path() const {
  return impl_->source.path();
}
const LasHeader& LasFile::header() const {
  return impl_->header;
}

std::size_t LasFile::num_chunks() const {
  if (!impl_->chunks.empty()) return impl_->chunks.size() - 1;
  const std::uint64_t count = impl_->header.point_count, size = impl_->chunk_points;
  return static_cast<std::size_t>(count / size + (count % size != 0 ? 1 : 0));
}

std::uint64_t LasFile::chunk_first_point(std::size_t chunk) const {
  assert(chunk <= num_chunks());
  return impl_->first_point(chunk);
}

std::uint64_t LasFile::chunk_point_count(std::size_t chunk) const {
  return chunk_first_point(chunk + 1) - chunk_first_point(chunk);
}

void LasFile::decode(std::size_t chunk, PointBatch& out, PointFields fields) const {
  assert(chunk < num_chunks());
  BatchSink sink(out, fields, impl_->header);
  impl_->decode(chunk, sink);
}

void LasFile::decode_records(std::size_t chunk, std::vector<std::byte>& out) const {
  assert(chunk < num_chunks());
  RecordSink sink(out, impl_->header);
  impl_->decode(chunk, sink);
}

}  // namespace hydrotin
