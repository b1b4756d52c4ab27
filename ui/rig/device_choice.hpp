#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <sys/types.h>

#include "protocols/protocol/protocol.hpp"

namespace palpate::ui {

/// What --device asks for.
struct DeviceChoice {
    enum class Kind : std::uint8_t {
        simulated,
        mouse,
        replay,
        haply,
        haply_emulator,
        board,
        comedi
    } kind = Kind::simulated;
    /// replay: the database; haply, board: the port, board also udp:HOST:PORT; comedi: the card's
    /// file.
    std::string file;
    std::optional<std::int64_t> trial{};  ///< replay: trial id; none: the file's trials in turn

    friend bool operator==(const DeviceChoice&, const DeviceChoice&) = default;
};

/// `sim`, `mouse`, `replay:FILE`, `replay:FILE:TRIAL`, `haply:PORT`, `haply-emulator`,
/// `board:PORT`, `board:udp:HOST:PORT`, `comedi:FILE`. A replay's FILE may hold colons: only a last
/// part that is a number is a trial.
/// @throws std::invalid_argument naming the value and the choices
[[nodiscard]] DeviceChoice parse_device(std::string_view text);

/// A person can hold it: what it records may be a person's.
[[nodiscard]] bool held_by_a_person(DeviceChoice::Kind kind) noexcept;

/// What a person holds pushes back. A pointer does not (PointerDevice::traits): real sessions are
/// held on it only where a protocol asks for it.
[[nodiscard]] bool gives_force(DeviceChoice::Kind kind) noexcept;

/// Both: such a rig is commissioned before a real session.
[[nodiscard]] inline bool pushes_a_person(DeviceChoice::Kind kind) noexcept {
    return held_by_a_person(kind) && gives_force(kind);
}

/// A real session of a study that asks for this class may be run on it.
[[nodiscard]] bool fits(protocols::DeviceClass asked, DeviceChoice::Kind kind) noexcept;

/// Surfaces are felt on machines that move in space, all else on those that move in a plane.
/// @param axes  of the machine, where one is named
/// @throws std::invalid_argument otherwise: what to give
void require_fit(const protocols::Protocol& protocol, const DeviceChoice& device, std::size_t axes);

/// What the device calls itself once it is opened (engine::Device::name()); an emulated board
/// without its port, which is another one each time.
/// @param machine  engine::Calibration::name()
/// @param surface  of a simulated hand: it moves in space
[[nodiscard]] std::string device_name(const DeviceChoice& choice,
                                      const std::string& machine,
                                      bool surface);

/// For --help and for errors.
inline constexpr std::string_view kDeviceWords =
    "sim, mouse, haply:PORT, haply-emulator, board:PORT, board:udp:HOST:PORT, comedi:FILE, or "
    "replay:FILE[:TRIAL]";

/// Help for --calibration.
inline constexpr std::string_view kCalibrationWords =
    "A file by palpate calibrate, or haplet, 2diy_gen2, 2diy_gen3, mk2";

/// What the kernel says of the other end of a port.
struct Behind {
    std::optional<pid_t> emulator{};  ///< the process of `palpate haply-emulator` that is the board
    bool unseen = false;              ///< a program of this machine, and nobody knows which
};

/// The protocol of a Haply board has no question that would tell, and an answer could be made up.
/// So the kernel is asked who holds the other end: the process whose terminal's master it is
/// (tty-index in /proc/PID/fdinfo), or whose UDP port of this machine; it is the emulator if it
/// calls itself haply-emulator. A real board has no such process, whatever it answers and through
/// whatever program: nothing is guessed from a port that is a pseudo-terminal. Where nobody is seen
/// to hold it (the program of another user, or of a container), it is unseen.
[[nodiscard]] Behind behind(const DeviceChoice& choice);

/// @throws std::runtime_error if palpate haply-emulator is behind that link already
void require_free(const std::string& link);

/// The same asked again, of a device that began anew.
/// @param before  when the session's kind was chosen by it
/// @return why the session may not go on with what is there now, a sentence with the remedy; empty:
/// it is of the same sort
[[nodiscard]] std::string other_behind(const DeviceChoice& choice, const Behind& before);

}  // namespace palpate::ui
