#include "engine/device/drivers/serial_link.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fcntl.h>
#include <linux/serial.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <termios.h>
#include <unistd.h>

namespace palpate::engine {
namespace {

namespace fs = std::filesystem;

constexpr unsigned kFirstTerminal = 136;  ///< major numbers of pseudo-terminals: 256 each
constexpr unsigned kTerminals = 8;

bool is_pseudo(const struct stat& port) noexcept {
    return major(port.st_rdev) - kFirstTerminal < kTerminals;
}

/// Pseudo-terminals of two containers have the same numbers.
bool is_same(const struct stat& port, const struct stat& open) noexcept {
    return S_ISCHR(open.st_mode) && open.st_rdev == port.st_rdev &&
           (!is_pseudo(port) || open.st_dev == port.st_dev);
}

/// The value after `name` in a file of lines "name:	value".
std::string value_of(const fs::path& file, const std::string& name) {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        if (line.starts_with(name + ":")) {
            const std::size_t from = line.find_first_not_of(" \t", name.size() + 1);
            return from == std::string::npos ? std::string() : line.substr(from);
        }
    }
    return {};
}

/// What is in a folder of /proc, whose processes come and go meanwhile.
std::vector<fs::path> entries(const fs::path& folder) {
    std::vector<fs::path> found;
    std::error_code error;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
        found.push_back(at->path());
    }
    return found;
}

/// Whether a process has the port open and not its other end.
bool holds(const fs::path& process, const struct stat& port) {
    const std::string index =
        std::to_string((major(port.st_rdev) - kFirstTerminal) * 256U + minor(port.st_rdev));
    bool open = false;
    for (const fs::path& file : entries(process / "fd")) {
        struct stat what {};
        if (stat(file.c_str(), &what) != 0) {
            continue;
        }
        open = open || is_same(port, what);
        const bool master = S_ISCHR(what.st_mode) && what.st_rdev == makedev(5, 2);
        if (is_pseudo(port) && master &&
            value_of(process / "fdinfo" / file.filename(), "tty-index") == index) {
            return false;
        }
    }
    return open;
}

/// Another program that has the serial port open, as "ModemManager (process 812)"; empty if none is
/// seen.
///
/// The system's locks bar only who comes later, or asks. Looked up in /proc, where files of other
/// users' programs are seen by root alone. The other end of a pseudo-terminal is the board itself,
/// and who holds it is no other program; nor is a child of this one, its guard.
std::string port_holder(const std::string& path) {
    struct stat port {};
    if (stat(path.c_str(), &port) != 0 || !S_ISCHR(port.st_mode)) {
        return {};
    }
    const std::string self = std::to_string(getpid());
    for (const fs::path& process : entries("/proc")) {
        const std::string id = process.filename().string();
        if (!std::all_of(id.begin(), id.end(),
                         [](unsigned char c) { return std::isdigit(c) != 0; }) ||
            id == self || !holds(process, port)) {
            continue;
        }
        const fs::path status = process / "status";
        if (value_of(status, "PPid") != self) {
            return value_of(status, "Name") + " (process " + id + ")";
        }
    }
    return {};
}

}  // namespace

std::string port_trouble(const std::string& path, int error) {
    switch (error) {
        case ENOENT:
        case ENODEV:
        case ENXIO:
        case EIO:
            return "there is no device at " + path +
                   ": is the board plugged in and switched on? `ls /dev/ttyACM* /dev/ttyUSB*` "
                   "lists the ports";
        case EACCES:
        case EPERM:
            return "no permission to use " + path +
                   ": join the group palpate that the Debian package makes (`sudo usermod -aG "
                   "palpate $USER`), or the port's own (`sudo usermod -aG dialout $USER`), and log "
                   "in again";
        case EBUSY:
        case EWOULDBLOCK:
            if (const std::string holder = port_holder(path); !holder.empty()) {
                return path + " is in use by another program, " + holder +
                       ", which could give force as well: end it and try again";
            }
            return path + " is in use by another program: end that one (`fuser -v " + path +
                   "` names it) and try again";
        case ENOTTY:
        case EINVAL:
        case EISDIR:
            return path + " is not a serial port: give the board's, such as /dev/ttyACM0";
        default:
            return path + " cannot be used: " + std::strerror(error);
    }
}

/// errno, or 0.
int SerialLink::configure() const noexcept {
    const int port = port_.get();
    termios raw{};
    if (tcgetattr(port, &raw) != 0) {
        return ENOTTY;
    }
    if (ioctl(port, TIOCEXCL) != 0 || flock(port, LOCK_EX | LOCK_NB) != 0) {
        return errno;
    }
    if (!port_holder(path_).empty()) {  // who had it open before the locks, and set it as they need
        ioctl(port, TIOCNXCL);
        return EBUSY;
    }
    cfmakeraw(&raw);
    cfsetspeed(&raw, megabaud_ ? B1000000 : B115200);
    raw.c_cflag |= CLOCAL | CREAD;
    raw.c_cflag &= ~static_cast<tcflag_t>(CSTOPB | CRTSCTS | HUPCL);
    raw.c_cc[VMIN] = 1;  // nothing there is EAGAIN, so that 0 bytes mean a hang-up
    raw.c_cc[VTIME] = 0;
    if (tcsetattr(port, TCSANOW, &raw) != 0) {
        return errno;
    }
    serial_struct chip{};
    if (megabaud_ && ioctl(port, TIOCGSERIAL, &chip) == 0) {
        chip.flags = static_cast<int>(static_cast<unsigned>(chip.flags) |
                                      ASYNC_LOW_LATENCY);  // an FTDI chip would gather for 16 ms
        ioctl(port, TIOCSSERIAL, &chip);
    }
    return 0;
}

bool SerialLink::reopen() {
    close();
    port_ = Descriptor(::open(path_.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
    const int error = port_.get() < 0 ? errno : configure();
    if (error == 0) {
        trouble_.clear();
        drain();
        return true;
    }
    DescriptorLink::close();  // not ours: the port may be another's, whose TIOCEXCL stays
    trouble_ = port_trouble(path_, error);
    return false;
}

void SerialLink::close() noexcept {
    ioctl(port_.get(), TIOCNXCL);
    DescriptorLink::close();
}

bool SerialLink::send(std::span<const std::uint8_t> packet) noexcept {
    ssize_t sent = -1;
    do {
        sent = ::write(port_.get(), packet.data(), packet.size());
    } while (sent < 0 && errno == EINTR);
    return sent == static_cast<ssize_t>(packet.size());
}

bool SerialLink::is_gone(std::ptrdiff_t got, int error) const noexcept {
    return got == 0 || (error != EAGAIN && error != EINTR);
}

}  // namespace palpate::engine
