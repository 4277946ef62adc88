#include "store.h"

#include <fcntl.h>
#include <hdf5.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <map>
#include <mutex>
#include <utility>

#include "hydrotin/version.h"
#include "store_filters.h"

namespace hydrotin::store {
namespace {

namespace fs = std::filesystem;

constexpr hsize_t kChunkElements = 16384;  // of an array that is longer; shorter ones are one chunk

// Every call into HDF5 holds this: builds of the library without thread safety are common.
std::recursive_mutex& library() {
  static std::recursive_mutex mutex;
  static const bool quiet = [] {
    H5open();
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    return true;
  }();
  (void)quiet;
  return mutex;
}

using Lock = std::lock_guard<std::recursive_mutex>;

// An HDF5 identifier and the function that closes it.
class Handle {
 public:
  Handle() = default;
  Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
  ~Handle() { reset(); }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    reset();
    id_ = std::exchange(other.id_, -1);
    close_ = other.close_;
    return *this;
  }
  [[nodiscard]] hid_t get() const { return id_; }
  [[nodiscard]] bool is_open() const { return id_ >= 0; }
  herr_t reset() {
    if (id_ < 0) return 0;
    const Lock lock(library());
    return close_(std::exchange(id_, -1));
  }

 private:
  hid_t id_ = -1;
  herr_t (*close_)(hid_t) = nullptr;
};

hid_t memory_type(Type type) {
  switch (type) {
    case Type::u8:
      return H5T_NATIVE_UINT8;
    case Type::i32:
      return H5T_NATIVE_INT32;
    case Type::u32:
      return H5T_NATIVE_UINT32;
    case Type::i64:
      return H5T_NATIVE_INT64;
    case Type::u64:
      return H5T_NATIVE_UINT64;
    case Type::f64:
      return H5T_NATIVE_DOUBLE;
  }
  return -1;
}

hid_t file_type(Type type) {
  switch (type) {
    case Type::u8:
      return H5T_STD_U8LE;
    case Type::i32:
      return H5T_STD_I32LE;
    case Type::u32:
      return H5T_STD_U32LE;
    case Type::i64:
      return H5T_STD_I64LE;
    case Type::u64:
      return H5T_STD_U64LE;
    case Type::f64:
      return H5T_IEEE_F64LE;
  }
  return -1;
}

std::size_t size_of(Type type) {
  switch (type) {
    case Type::u8:
      return 1;
    case Type::i32:
    case Type::u32:
      return 4;
    default:
      return 8;
  }
}

[[noreturn]] void fail(const std::string& path, const std::string& what, const std::string& remedy) {
  throw Error(ErrorKind::storage, path + ": " + what + "; " + remedy);
}

void write_text(hid_t object, const std::string& name, const std::string& text) {
  Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), std::max<std::size_t>(text.size(), 1));
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(object, name.c_str(), type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  H5Awrite(attribute.get(), type.get(), text.empty() ? "\0" : text.data());
}

}  // namespace

std::unique_lock<std::recursive_mutex> lock_library() {
  return std::unique_lock(library());
}

struct Writer::Impl {
  std::string path, temporary;
  Handle file;

  struct Column {
    Type type;
    std::string meaning;
    Handle dataset{};                  // made once it is known whether the array is longer than one chunk
    hsize_t written = 0;               // elements in complete chunks
    std::vector<std::byte> pending{};  // less than one chunk
  };
  std::map<std::string, Column> columns;
  ChunkCodec codec;
  std::vector<std::byte> padded, encoded;  // one chunk

  [[noreturn]] void fail_writing(const std::string& what) const {
    fail(path, what + " (" + std::strerror(errno) + ")", "check free space and permissions, then run again");
  }

  Column& column(const std::string& name, Type type, std::string_view meaning) {
    const auto found = columns.find(name);
    return found != columns.end() ? found->second
                                  : columns.emplace(name, Column{type, std::string(meaning)}).first->second;
  }

  void create(const std::string& name, Column& column, hsize_t chunk) const {
    const Lock lock(library());
    const hsize_t zero = 0, unlimited = H5S_UNLIMITED;
    const Handle space(H5Screate_simple(1, &zero, &unlimited), H5Sclose);
    const Handle create(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    H5Pset_chunk(create.get(), 1, &chunk);
    H5Pset_shuffle(create.get());
    H5Pset_deflate(create.get(), 1);
    H5Pset_fletcher32(create.get());
    H5Pset_obj_track_times(create.get(), false);  // equal content, equal bytes
    column.dataset = Handle(H5Dcreate2(file.get(), name.c_str(), file_type(column.type), space.get(), H5P_DEFAULT,
                                       create.get(), H5P_DEFAULT),
                            H5Dclose);
    if (!column.dataset.is_open()) fail_writing("cannot create the array '" + name + "'");
    if (!column.meaning.empty()) write_text(column.dataset.get(), "meaning", column.meaning);
  }

  // Writes one chunk; a short last one of several is padded with zeros. An array shorter than a chunk is a chunk of its
  // own size: runs with many small tiles would else spend their time on zeros.
  void write_chunk(const std::string& name, Column& column, std::span<const std::byte> bytes, hsize_t elements) {
    const std::size_t size = size_of(column.type);
    if (!column.dataset.is_open()) create(name, column, elements);
    if (column.written > 0 && elements < kChunkElements) {
      padded.assign(bytes.begin(), bytes.end());
      padded.resize(kChunkElements * size);
      bytes = padded;
    }
    codec.encode(bytes, size, encoded);
    const Lock lock(library());
    const hsize_t extent = column.written + elements, offset = column.written;
    if (H5Dset_extent(column.dataset.get(), &extent) < 0 ||
        H5Dwrite_chunk(column.dataset.get(), H5P_DEFAULT, 0, &offset, encoded.size(), encoded.data()) < 0)
      fail_writing("cannot write the array '" + name + "'");
    column.written = extent;
  }
};

Writer::Writer(const std::string& path) : impl_(std::make_unique<Impl>()) {
  static std::atomic<unsigned> serial{0};
  impl_->path = path;
  impl_->temporary = path + ".part-" + std::to_string(::getpid()) + "-" + std::to_string(serial++);
  std::error_code ignored;
  fs::create_directories(fs::path(path).parent_path(), ignored);
  const Lock lock(library());
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  H5Pset_libver_bounds(access.get(), H5F_LIBVER_V18, H5F_LIBVER_V110);
  const Handle create(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
  H5Pset_obj_track_times(create.get(), false);
  errno = 0;
  impl_->file = Handle(H5Fcreate(impl_->temporary.c_str(), H5F_ACC_EXCL, create.get(), access.get()), H5Fclose);
  if (!impl_->file.is_open()) impl_->fail_writing("cannot create the file");
  write_text(impl_->file.get(), "writer", std::string("hydrotin ") + version());
}

Writer::~Writer() {
  if (!impl_ || !impl_->file.is_open()) return;
  impl_->columns.clear();
  impl_->file.reset();
  ::unlink(impl_->temporary.c_str());
}

void Writer::append_bytes(const std::string& name, Type type, const void* data, std::size_t count,
                          std::string_view meaning) {
  Impl::Column& column = impl_->column(name, type, meaning);
  const std::size_t size = size_of(type), chunk = kChunkElements * size;
  std::span<const std::byte> bytes(static_cast<const std::byte*>(data), count * size);
  auto& pending = column.pending;
  if (!pending.empty()) {
    const std::size_t take = std::min(bytes.size(), chunk - pending.size());
    pending.insert(pending.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(take));
    bytes = bytes.subspan(take);
    if (pending.size() < chunk) return;
    impl_->write_chunk(name, column, pending, kChunkElements);
    pending.clear();
  }
  for (; bytes.size() >= chunk; bytes = bytes.subspan(chunk))
    impl_->write_chunk(name, column, bytes.first(chunk), kChunkElements);
  pending.assign(bytes.begin(), bytes.end());
}

void Writer::set(const std::string& attribute, const std::string& text) {
  const Lock lock(library());
  write_text(impl_->file.get(), attribute, text);
}

namespace {

void write_scalar(hid_t file, const std::string& name, hid_t stored, hid_t native, const void* value) {
  const Lock lock(library());
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle attribute(H5Acreate2(file, name.c_str(), stored, space.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  H5Awrite(attribute.get(), native, value);
}

void sync(const std::string& path, int flags) {
  const int fd = ::open(path.c_str(), flags);
  if (fd < 0) return;
  ::fsync(fd);
  ::close(fd);
}

}  // namespace

void sync_folder(const std::string& folder) {
  sync(folder, O_RDONLY | O_DIRECTORY);
}

void Writer::set(const std::string& attribute, std::int64_t value) {
  write_scalar(impl_->file.get(), attribute, H5T_STD_I64LE, H5T_NATIVE_INT64, &value);
}

void Writer::set(const std::string& attribute, double value) {
  write_scalar(impl_->file.get(), attribute, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, &value);
}

void Writer::commit() {
  for (auto& [name, column] : impl_->columns) {
    if (!column.pending.empty())
      impl_->write_chunk(name, column, column.pending, column.pending.size() / size_of(column.type));
    if (!column.dataset.is_open()) impl_->create(name, column, 1);  // an empty array
    if (column.dataset.reset() < 0) impl_->fail_writing("cannot finish the array '" + name + "'");
  }
  impl_->columns.clear();
  {
    const Lock lock(library());
    if (H5Fflush(impl_->file.get(), H5F_SCOPE_GLOBAL) < 0 || impl_->file.reset() < 0) {
      ::unlink(impl_->temporary.c_str());
      impl_->fail_writing("cannot finish the file");
    }
  }
  sync(impl_->temporary, O_RDONLY);
  if (::rename(impl_->temporary.c_str(), impl_->path.c_str()) != 0) {
    const int error = errno;
    ::unlink(impl_->temporary.c_str());
    errno = error;
    impl_->fail_writing("cannot rename the finished file");
  }
}

struct Reader::Impl {
  std::string path;
  Handle file;

  struct Column {
    Handle dataset;
    hsize_t size = 0, chunk = 0;
    bool direct = false;  // written with our own pipeline
  };
  mutable std::map<std::string, Column> columns{};
  mutable ChunkCodec codec{};

  [[noreturn]] void damaged(const std::string& what) const {
    fail(path, what, "the file is damaged or not of this program: delete it and run again");
  }

  const Column& column(const std::string& name) const {
    const auto found = columns.find(name);
    if (found != columns.end()) return found->second;
    const Lock lock(library());
    Column column{Handle(H5Dopen2(file.get(), name.c_str(), H5P_DEFAULT), H5Dclose)};
    if (!column.dataset.is_open()) damaged("the array '" + name + "' is missing");
    const Handle space(H5Dget_space(column.dataset.get()), H5Sclose);
    if (H5Sget_simple_extent_ndims(space.get()) != 1) damaged("the array '" + name + "' has a wrong shape");
    H5Sget_simple_extent_dims(space.get(), &column.size, nullptr);
    const Handle create(H5Dget_create_plist(column.dataset.get()), H5Pclose);
    if (H5Pget_layout(create.get()) == H5D_CHUNKED) H5Pget_chunk(create.get(), 1, &column.chunk);
    column.direct = column.chunk > 0 && column.chunk <= kChunkElements && H5Pget_nfilters(create.get()) == 3;
    const std::array<H5Z_filter_t, 3> ours{H5Z_FILTER_SHUFFLE, H5Z_FILTER_DEFLATE, H5Z_FILTER_FLETCHER32};
    for (unsigned i = 0; column.direct && i < 3; ++i) {
      unsigned flags = 0;
      std::size_t elements = 0;
      unsigned config = 0;
      column.direct = H5Pget_filter2(create.get(), i, &flags, &elements, nullptr, 0, nullptr, &config) == ours[i];
    }
    return columns.emplace(name, std::move(column)).first->second;
  }
};

Reader::Reader(const std::string& path) : impl_(std::make_unique<Impl>()) {
  impl_->path = path;
  std::error_code missing;
  const std::uintmax_t bytes = fs::file_size(path, missing);
  if (missing) fail(path, "the file is missing", "run the phase that makes it");
  const Lock lock(library());
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  constexpr std::uintmax_t kReadWhole = std::uintmax_t{64} << 10;  // one call instead of dozens
  if (bytes <= kReadWhole) H5Pset_fapl_core(access.get(), kReadWhole, false);
  impl_->file = Handle(H5Fopen(path.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose);
  if (!impl_->file.is_open()) impl_->damaged("not a readable HDF5 file");
}

Reader::~Reader() = default;
Reader::Reader(Reader&&) noexcept = default;
Reader& Reader::operator=(Reader&&) noexcept = default;

const std::string& Reader::path() const {
  return impl_->path;
}

bool Reader::has(const std::string& name) const {
  const Lock lock(library());
  return H5Lexists(impl_->file.get(), name.c_str(), H5P_DEFAULT) > 0;
}

std::uint64_t Reader::size(const std::string& name) const {
  // More than a chunk's share of the file's bytes times deflate's best ratio cannot be true.
  const Impl::Column& column = impl_->column(name);
  std::error_code ignored;
  const auto bytes = fs::file_size(impl_->path, ignored);
  if (column.direct && column.size / 1100 > bytes) impl_->damaged("the array '" + name + "' claims an impossible size");
  return column.size;
}

void Reader::read_bytes(const std::string& name, Type type, std::uint64_t first, std::uint64_t count, void* out) const {
  if (count == 0) return;
  const Impl::Column& column = impl_->column(name);
  if (first + count > column.size) impl_->damaged("the array '" + name + "' is too short");
  const std::size_t size = size_of(type);
  {
    const Lock lock(library());
    const Handle stored(H5Dget_type(column.dataset.get()), H5Tclose);
    if (H5Tequal(stored.get(), file_type(type)) <= 0) impl_->damaged("the array '" + name + "' has a wrong type");
  }
  if (!column.direct) {
    const Lock lock(library());
    const Handle space(H5Dget_space(column.dataset.get()), H5Sclose);
    const hsize_t start = first, length = count;
    H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, &start, nullptr, &length, nullptr);
    const Handle memory(H5Screate_simple(1, &length, nullptr), H5Sclose);
    if (H5Dread(column.dataset.get(), memory_type(type), memory.get(), space.get(), H5P_DEFAULT, out) < 0)
      impl_->damaged("the array '" + name + "' cannot be read");
    return;
  }
  std::vector<std::byte> encoded, chunk(column.chunk * size);
  auto* target = static_cast<std::byte*>(out);
  for (std::uint64_t offset = first / column.chunk * column.chunk; offset < first + count; offset += column.chunk) {
    {
      const Lock lock(library());
      const hsize_t at = offset;
      hsize_t bytes = 0;
      std::uint32_t mask = 0;
      if (H5Dget_chunk_storage_size(column.dataset.get(), &at, &bytes) < 0 || bytes == 0 ||
          bytes > 2 * chunk.size() + 1024)
        impl_->damaged("a part of the array '" + name + "' is missing");
      encoded.resize(bytes);
      if (H5Dread_chunk(column.dataset.get(), H5P_DEFAULT, &at, &mask, encoded.data()) < 0 || mask != 0)
        impl_->damaged("a part of the array '" + name + "' cannot be read");
    }
    if (!impl_->codec.decode(encoded, size, chunk)) impl_->damaged("the checksum of the array '" + name + "' is wrong");
    const std::uint64_t begin = std::max(first, offset);
    const std::uint64_t end = std::min(first + count, offset + std::uint64_t{column.chunk});
    std::memcpy(target + (begin - first) * size, chunk.data() + (begin - offset) * size, (end - begin) * size);
  }
}

bool Reader::has_attribute(const std::string& attribute) const {
  const Lock lock(library());
  return H5Aexists(impl_->file.get(), attribute.c_str()) > 0;
}

std::string Reader::text(const std::string& name) const {
  const Lock lock(library());
  const Handle attribute(H5Aopen(impl_->file.get(), name.c_str(), H5P_DEFAULT), H5Aclose);
  if (!attribute.is_open()) impl_->damaged("the attribute '" + name + "' is missing");
  const Handle type(H5Aget_type(attribute.get()), H5Tclose);
  if (H5Tget_class(type.get()) != H5T_STRING || H5Tis_variable_str(type.get()) != 0)
    impl_->damaged("the attribute '" + name + "' is not a text");
  std::string text(H5Tget_size(type.get()), '\0');
  if (H5Aread(attribute.get(), type.get(), text.data()) < 0)
    impl_->damaged("the attribute '" + name + "' cannot be read");
  text.resize(std::strlen(text.c_str()));
  return text;
}

std::int64_t Reader::integer(const std::string& name) const {
  const Lock lock(library());
  const Handle attribute(H5Aopen(impl_->file.get(), name.c_str(), H5P_DEFAULT), H5Aclose);
  std::int64_t value = 0;
  if (!attribute.is_open() || H5Aread(attribute.get(), H5T_NATIVE_INT64, &value) < 0)
    impl_->damaged("the attribute '" + name + "' is missing or not a number");
  return value;
}

double Reader::real(const std::string& name) const {
  const Lock lock(library());
  const Handle attribute(H5Aopen(impl_->file.get(), name.c_str(), H5P_DEFAULT), H5Aclose);
  double value = 0;
  if (!attribute.is_open() || H5Aread(attribute.get(), H5T_NATIVE_DOUBLE, &value) < 0)
    impl_->damaged("the attribute '" + name + "' is missing or not a number");
  return value;
}

std::string recipe_of(const std::string& path) {
  if (!fs::exists(path)) return {};
  try {
    const Reader reader(path);
    return reader.has_attribute("recipe") ? reader.text("recipe") : std::string();
  } catch (const Error&) {
    return {};
  }
}

}  // namespace hydrotin::store
