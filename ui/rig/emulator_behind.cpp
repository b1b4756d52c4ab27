#include "ui/rig/emulator_behind.hpp"

#include <filesystem>
#include <sstream>
#include <string>
#include <system_error>

#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include "engine/base/files.hpp"
#include "engine/base/parsed.hpp"
#include "engine/device/drivers/udp_link.hpp"

namespace palpate::ui {
namespace {

namespace fs = std::filesystem;

constexpr unsigned kFirstPtyMajor = 136;  // Unix98 slaves: 136 to 143, 256 of them each
constexpr unsigned kLastPtyMajor = 143;
constexpr const char* kName = "haply-emulator";  // engine::run_like_a_board gives it

/// What stands in /proc/PID/fdinfo of the master, if `port` is a pseudo-terminal.
std::string master_words(const std::string& port) {
    struct stat seen {};
    if (stat(port.c_str(), &seen) != 0 || !S_ISCHR(seen.st_mode) ||
        major(seen.st_rdev) < kFirstPtyMajor || major(seen.st_rdev) > kLastPtyMajor) {
        return {};
    }
    const unsigned index = (major(seen.st_rdev) - kFirstPtyMajor) * 256 + minor(seen.st_rdev);
    return fmt::format("tty-index:\t{}\n", index);
}

/// What /proc/PID/fd says of the socket that listens on this port of this machine.
std::string socket_words(const std::string& port) {
    const engine::UdpAddress address = engine::udp_address(port);
    if (address.host != "localhost" && address.host != "::1" && !address.host.starts_with("127.")) {
        return {};
    }
    const std::string local = fmt::format(":{:04X}", parsed<int>(address.port).value_or(0));
    for (const char* table : {"/proc/net/udp", "/proc/net/udp6"}) {
        std::istringstream lines(file_text(table));
        for (std::string line; std::getline(lines, line);) {
            std::istringstream words(line);
            std::string word;
            std::string at;
            words >> word >> at;
            for (int i = 0; i < 8; ++i) {
                words >> word;
            }
            if (at.ends_with(local)) {
                return "socket:[" + word + "]";
            }
        }
    }
    return {};
}

/// That process has an open file of which the kernel says `words`.
bool holds(const fs::path& process, const std::string& words) {
    std::error_code unseen;
    const bool is_socket = words.starts_with("socket:");
    for (const auto& file :
         fs::directory_iterator(process / (is_socket ? "fd" : "fdinfo"), unseen)) {
        std::error_code gone;
        const std::string said =
            is_socket ? fs::read_symlink(file.path(), gone).string() : file_text(file.path());
        if (said.find(words) != std::string::npos) {
            return true;
        }
    }
    return false;
}

}  // namespace

Behind behind(const DeviceChoice& choice) {
    if (choice.kind != DeviceChoice::Kind::haply && choice.kind != DeviceChoice::Kind::board) {
        return {};
    }
    const std::string words = choice.file.starts_with(engine::kUdp) ? socket_words(choice.file)
                                                                    : master_words(choice.file);
    bool seen = false;
    std::error_code unread;
    for (const auto& entry : fs::directory_iterator("/proc", unread)) {
        const std::string name = entry.path().filename().string();
        const auto id = parsed<pid_t>(name);
        if (words.empty() || !id || !holds(entry.path(), words)) {
            continue;
        }
        if (file_text(entry.path() / "comm") == std::string(kName) + "\n") {
            return {.emulator = *id};
        }
        seen = true;
    }
    return {.unseen = !words.empty() && !seen};
}

}  // namespace palpate::ui
