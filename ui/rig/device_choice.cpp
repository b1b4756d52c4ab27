#include "ui/rig/device_choice.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <vector>

#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include "engine/base/files.hpp"
#include "engine/base/refuse.hpp"
#include "engine/base/text.hpp"
#include "engine/device/drivers/udp_link.hpp"

namespace palpate::ui {
namespace {

using Kind = DeviceChoice::Kind;

/// What stands after `word:` in `text`; none if it is not there.
std::optional<std::string> after(std::string_view text, std::string_view word) {
    if (text.size() <= word.size() + 1 || !text.starts_with(word) || text[word.size()] != ':') {
        return std::nullopt;
    }
    return std::string(text.substr(word.size() + 1));
}

using Asked = protocols::DeviceClass;

/// What --device may name, in the order in which they are listed.
struct DeviceWord {
    std::string_view name;
    Kind kind;
    std::string_view takes;   ///< what stands behind its colon; empty: it has none
    std::string_view called;  ///< by its machine, and what stands there
    bool held = false;        ///< a person can hold it
    bool gives_force = true;
    Asked asked = Asked::any;  ///< a protocol asks for it so
};
constexpr std::array<DeviceWord, 7> kDevices{
    {{"sim", Kind::simulated, "", "simulated pantograph"},
     {"mouse", Kind::mouse, "", "mouse", true, false, Asked::mouse},
     {"haply", Kind::haply, "PORT", "Haply {0} at {1}", true, true, Asked::haply},
     {"haply-emulator", Kind::haply_emulator, "", "emulated Haply {0}"},
     {"board", Kind::board, "PORT", "open board {0} at {1}", true, true, Asked::board},
     {"comedi", Kind::comedi, "FILE", "comedi {1} ({0})", true, true, Asked::comedi},
     {"replay", Kind::replay, "FILE", "replay of {1}", false, false}}};

const DeviceWord& row_of(Kind kind) noexcept {
    return *std::ranges::find(kDevices, kind, &DeviceWord::kind);
}

DeviceChoice replay_of(std::string file) {
    DeviceChoice choice{.kind = Kind::replay, .file = std::move(file)};
    const std::size_t colon = choice.file.rfind(':');
    if (colon != std::string::npos && colon > 0) {
        const auto trial = parsed<std::int64_t>(std::string_view(choice.file).substr(colon + 1));
        if (trial) {
            choice.trial = *trial;
            choice.file.resize(colon);
        }
    }
    return choice;
}

namespace fs = std::filesystem;

constexpr unsigned kFirstPtyMajor = 136;  // Unix98 slaves: 136 to 143, 256 of them each
constexpr unsigned kLastPtyMajor = 143;
constexpr const char* kName = "haply-emulator";  // engine::run_like_a_board gives it

/// How the kernel names the other end of a port.
struct OtherEnd {
    std::string words{};  ///< in /proc/PID/fdinfo of a master, or of a socket as /proc/PID/fd says
    std::string slave{};  ///< of a master, below the root of its process
    dev_t terminals{};    ///< that it is of: containers have the same numbers
};

/// If `port` is a pseudo-terminal.
OtherEnd master_of(const std::string& port) {
    struct stat seen {};
    if (stat(port.c_str(), &seen) != 0 || !S_ISCHR(seen.st_mode) ||
        major(seen.st_rdev) < kFirstPtyMajor || major(seen.st_rdev) > kLastPtyMajor) {
        return {};
    }
    const unsigned index = (major(seen.st_rdev) - kFirstPtyMajor) * 256 + minor(seen.st_rdev);
    return {.words = fmt::format("tty-index:\t{}\n", index),
            .slave = fmt::format("root/dev/pts/{}", index),
            .terminals = seen.st_dev};
}

/// That listens on this port of this machine.
OtherEnd socket_of(const std::string& port) {
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
                return {.words = "socket:[" + word + "]"};
            }
        }
    }
    return {};
}

/// That process has it open.
bool holds(const fs::path& process, const OtherEnd& end) {
    std::error_code unseen;
    const bool is_socket = end.slave.empty();
    struct stat slave {};
    if (!is_socket && stat((process / end.slave).c_str(), &slave) == 0 &&
        slave.st_dev != end.terminals) {
        return false;
    }
    for (const auto& file :
         fs::directory_iterator(process / (is_socket ? "fd" : "fdinfo"), unseen)) {
        std::error_code gone;
        const std::string said =
            is_socket ? fs::read_symlink(file.path(), gone).string() : file_text(file.path());
        if (said.find(end.words) != std::string::npos) {
            return true;
        }
    }
    return false;
}

}  // namespace

DeviceChoice parse_device(std::string_view text) {
    std::vector<std::string_view> names;
    for (const DeviceWord& one : kDevices) {
        names.push_back(one.name);
        if (one.takes.empty() && text == one.name) {
            return {.kind = one.kind, .file = {}};
        }
        refuse_if(!one.takes.empty() && trimmed(text, ":") == one.name,
                  "--device {}: say which one, as {}:{}", text, one.name, one.takes);
        if (auto file = one.takes.empty() ? std::nullopt : after(text, one.name)) {
            if (one.kind == Kind::board && file->starts_with(engine::kUdp)) {
                static_cast<void>(engine::udp_address(*file));  // throws before anything is made
            }
            return one.kind == Kind::replay
                     ? replay_of(*std::move(file))
                     : DeviceChoice{.kind = one.kind, .file = *std::move(file)};
        }
    }
    throw std::invalid_argument(fmt::format("--device {}: no such device{}; give {}", text,
                                            suggestion(text.substr(0, text.find(':')), names, ""),
                                            kDeviceWords));
}

bool fits(protocols::DeviceClass asked, DeviceChoice::Kind kind) noexcept {
    return asked == Asked::any || asked == row_of(kind).asked;
}

void require_fit(const protocols::Protocol& protocol,
                 const DeviceChoice& device,
                 std::size_t axes) {
    const bool either = device.kind == Kind::simulated || device.kind == Kind::replay;
    if (either || protocol.surface.has_value() == (axes > 2)) {
        return;
    }
    throw std::invalid_argument(
        protocol.surface
            ? fmt::format("the objects of {} are surfaces in space, and the device that was named "
                          "moves in a plane: give --device sim, board:PORT with the --calibration "
                          "of a machine of three axes, or replay:FILE of a session with surfaces",
                          protocol.id)
            : fmt::format("the objects of {} are curves in a plane, and the machine of that "
                          "calibration has three axes: give the calibration of a pantograph, or a "
                          "protocol with [surface]",
                          protocol.id));
}

bool gives_force(Kind kind) noexcept {
    return row_of(kind).gives_force;
}

bool held_by_a_person(Kind kind) noexcept {
    return row_of(kind).held;
}

std::string device_name(const DeviceChoice& choice, const std::string& machine, bool surface) {
    return surface && choice.kind == Kind::simulated
             ? "simulated gantry"
             : fmt::format(fmt::runtime(row_of(choice.kind).called), machine, choice.file);
}

Behind behind(const DeviceChoice& choice) {
    if (choice.kind != DeviceChoice::Kind::haply && choice.kind != DeviceChoice::Kind::board) {
        return {};
    }
    const OtherEnd end =
        choice.file.starts_with(engine::kUdp) ? socket_of(choice.file) : master_of(choice.file);
    bool seen = false;
    std::error_code unread;
    for (const auto& entry : fs::directory_iterator("/proc", unread)) {
        const std::string name = entry.path().filename().string();
        const auto id = parsed<pid_t>(name);
        if (end.words.empty() || !id || !holds(entry.path(), end)) {
            continue;
        }
        if (file_text(entry.path() / "comm") == std::string(kName) + "\n") {
            return {.emulator = *id};
        }
        seen = true;
    }
    return {.unseen = !end.words.empty() && !seen};
}

void require_free(const std::string& link) {
    const auto other = behind({.kind = Kind::haply, .file = link}).emulator;
    refuse_if<std::runtime_error>(
        other.has_value(),
        "--link {}: palpate haply-emulator, process {}, is there: end it, or give another name",
        link, other.value_or(0));
}

std::string other_behind(const DeviceChoice& choice, const Behind& before) {
    constexpr const char* kRemedy =
        "put back what the session was begun with, or end it: the command that goes on asks what "
        "it is";
    const Behind now = behind(choice);
    const std::string port =
        fmt::format("--device {}:{}", choice.kind == Kind::haply ? "haply" : "board", choice.file);
    if (now.unseen && !before.unseen) {
        return fmt::format(
            "behind {} is now a program that this user cannot see, and it may be an emulator: {}",
            port, kRemedy);
    }
    if (now.emulator && !before.emulator) {
        return fmt::format(
            "behind {} is now palpate haply-emulator, process {}, and the session was begun on "
            "something else: {}",
            port, *now.emulator, kRemedy);
    }
    return now.emulator || !before.emulator
             ? std::string()
             : fmt::format(
                   "behind {} is no longer palpate haply-emulator, with which the session was "
                   "begun, and nobody proved what is there: {}",
                   port, kRemedy);
}

}  // namespace palpate::ui
