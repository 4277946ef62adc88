#pragma once

namespace hydrotin {

/// The program's version, written into every file it makes.
[[nodiscard]] const char* version();

}  // namespace hydrotin
