// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "command/terminal.h"

#if defined(_WIN32)
#include <fcntl.h>
#include <io.h>
#else
#include <unistd.h>

#include <csignal>
#include <initializer_list>
#endif

namespace limber::program {

#if defined(_WIN32)

bool is_terminal(std::FILE* stream) { return _isatty(_fileno(stream)) != 0; }

void prepare_streams() {
  for (std::FILE* const stream : {stdout, stderr}) _setmode(_fileno(stream), _O_BINARY);  // line ends stay as they are
}

#else

bool is_terminal(std::FILE* stream) { return isatty(fileno(stream)) != 0; }

void prepare_streams() {
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
}

#endif

}  // namespace limber::program
