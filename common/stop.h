// Stopping on request. Signal handlers only raise a flag; the work checks it between frames and steps.
#pragma once

namespace vivify {

// Installs handlers: SIGTERM and SIGUSR1 ask for a stop (exit 75), SIGINT interrupts (exit 130).
void install_stop_handlers();

// Throws Error(stopped) or Error(interrupted) once a stop was asked for.
void check_stop();

}  // namespace vivify
