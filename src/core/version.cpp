#include "hydrotin/version.h"

namespace hydrotin {

const char* version() { return HYDROTIN_VERSION; }

}  // namespace hydrotin
