// SPDX-License-Identifier: GPL-3.0-or-later
// glog enters its flags into gflags' table, and a second copy of gflags in one process ends the process:
// Debian's Blender brings the first. Nobody parses flags here, so they are entered nowhere and gflags
// stays out. The declaration is gflags 2.2's, which Debian's glog was compiled against.
#include <string>

namespace google {

class FlagRegisterer {
public:
    template <typename FlagType>
    FlagRegisterer(const char* name, const char* help, const char* filename, FlagType* current_storage,
                   FlagType* defvalue_storage);
};

template <typename FlagType>
FlagRegisterer::FlagRegisterer(const char*, const char*, const char*, FlagType*, FlagType*) {}

template FlagRegisterer::FlagRegisterer(const char*, const char*, const char*, bool*, bool*);
template FlagRegisterer::FlagRegisterer(const char*, const char*, const char*, int*, int*);
template FlagRegisterer::FlagRegisterer(const char*, const char*, const char*, unsigned*, unsigned*);
template FlagRegisterer::FlagRegisterer(const char*, const char*, const char*, std::string*, std::string*);

}  // namespace google
