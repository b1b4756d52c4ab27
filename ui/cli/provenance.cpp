#include "ui/cli/provenance.hpp"

#include <gnu/libc-version.h>
#include <sys/utsname.h>

#include "ui/cli/version.hpp"

namespace palpate::ui {

std::vector<std::pair<std::string, std::string>> provenance() {
    utsname system{};
    uname(&system);
    return {{"palpate", kVersion},
            {"compiler", __VERSION__},
            {"libc", gnu_get_libc_version()},
            {"kernel", std::string(system.sysname) + " " + system.release},
            {"machine", system.machine}};
}

}  // namespace palpate::ui
