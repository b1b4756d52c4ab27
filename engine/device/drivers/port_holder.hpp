#pragma once

#include <string>

namespace palpate::engine {

/// Another program that has the serial port open, as "ModemManager (process 812)"; empty if none is
/// seen.
///
/// The system's locks bar only who comes later, or asks. Looked up in /proc, where files of other
/// users' programs are seen by root alone. The other end of a pseudo-terminal is the board itself,
/// and who holds it is no other program; nor is a child of this one, its guard.
[[nodiscard]] std::string port_holder(const std::string& path);

}  // namespace palpate::engine
