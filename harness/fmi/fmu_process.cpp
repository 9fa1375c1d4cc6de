#include "harness/fmi/fmu_process.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <utility>

#include "harness/state_bytes.h"

namespace quayside::harness {

namespace fs = std::filesystem;

namespace {

using Bytes = UnitState;

// What the one who waits has asked for. The names complete "it crashed in".
enum class Call : std::uint8_t { load, enter_initialization, exit_initialization, step, read, save, restore, terminate, reset, quit };
const char* to_string(Call call) {
  switch (call) {
    case Call::load: return "being loaded";
    case Call::enter_initialization: return "entering initialization mode";
    case Call::exit_initialization: return "leaving initialization mode";
    case Call::step: return "its step";
    case Call::read: return "being read";
    case Call::save: return "being saved";
    case Call::restore: return "being restored";
    case Call::terminate: return "being terminated";
    case Call::reset: return "being reset";
    case Call::quit: return "being freed";
  }
  return "";
}

enum class Answer : std::uint8_t { done, refused, failed };

constexpr double kPatienceAtTheEnd = 1;  // for an FMU to free itself [s]

// --- Messages: a length and so many bytes ----------------------------------------------------------------------------

class Channel {
 public:
  explicit Channel(int socket) : socket_(socket) {}
  ~Channel() { close(socket_); }
  Channel(const Channel&) = delete;
  Channel& operator=(const Channel&) = delete;

  // False when the other side is gone.
  bool send(const Bytes& message) const {
    const std::uint64_t size = message.size();
    return send_all(&size, sizeof size) && send_all(message.data(), message.size());
  }
  // Waits for `patience` seconds at most; negative: for ever.
  enum class Received { message, end, nothing };
  Received receive(Bytes& message, double patience) const {
    const auto deadline = Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(patience));
    std::uint64_t size = 0;
    const Received received = receive_all(&size, sizeof size, patience < 0, deadline);
    if (received != Received::message) return received;
    message.resize(size);
    return receive_all(message.data(), size, patience < 0, deadline);
  }

 private:
  using Clock = std::chrono::steady_clock;

  bool send_all(const void* data, std::size_t size) const {
    for (const char* at = static_cast<const char*>(data); size > 0;) {
      const ssize_t sent = ::send(socket_, at, size, MSG_NOSIGNAL);
      if (sent < 0 && errno == EINTR) continue;
      if (sent <= 0) return false;
      at += sent;
      size -= static_cast<std::size_t>(sent);
    }
    return true;
  }
  Received receive_all(void* data, std::size_t size, bool for_ever, Clock::time_point deadline) const {
    for (char* at = static_cast<char*>(data); size > 0;) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
      pollfd wanted{socket_, POLLIN, 0};
      const int ready = poll(&wanted, 1, for_ever ? -1 : static_cast<int>(std::max<long>(0, left)));
      if (ready < 0 && errno == EINTR) continue;
      if (ready == 0) return Received::nothing;
      const ssize_t received = recv(socket_, at, size, 0);
      if (received < 0 && errno == EINTR) continue;
      if (received <= 0) return Received::end;
      at += received;
      size -= static_cast<std::size_t>(received);
    }
    return Received::message;
  }

  int socket_;
};

void put(ByteWriter& out, const std::string& text) {
  for (const char c : text) out.put(c);
}

// --- The child -------------------------------------------------------------------------------------------------------

void write_outputs(ForeignFmu& fmu, const FmuDescription& description, ByteWriter& out) {
  for (const FmuVariable& v : description.variables) {
    if (v.variable.causality == Causality::output) out.put(fmu.get(v));
  }
}

// Returns whether there is more to come.
bool answer(ForeignFmu& fmu, const FmuDescription& description, const Bytes& request, ByteWriter& out) {
  ByteReader in(request);
  for (auto left = in.get<std::uint32_t>(); left > 0; --left) {
    const auto variable = in.get<std::uint32_t>();
    fmu.set(description.variables[variable], in.get<double>());
  }
  switch (in.get<Call>()) {
    case Call::enter_initialization: fmu.enter_initialization_mode(in.get<double>()); break;
    case Call::exit_initialization: fmu.exit_initialization_mode(); break;
    case Call::step: {
      const double now = in.get<double>(), length = in.get<double>();
      const ForeignFmu::Step step = fmu.step(now, length);
      out.put(step.reached);
      out.put(step.terminate);
      write_outputs(fmu, description, out);
      break;
    }
    case Call::read: {
      const auto variable = in.get<std::uint32_t>();
      out.put(fmu.get(description.variables[variable]));
      write_outputs(fmu, description, out);
      break;
    }
    case Call::save:
      for (const std::byte byte : fmu.save()) out.put(byte);
      break;
    case Call::restore: {
      Bytes state(in.get<std::uint64_t>());
      for (std::byte& byte : state) in.get(byte);
      fmu.restore(state);
      break;
    }
    case Call::terminate: fmu.terminate(); break;
    case Call::reset: fmu.reset(); break;
    case Call::load: break;
    case Call::quit: return false;
  }
  return true;
}

// Runs `action`, which fills the reply, and sends that, or what went wrong. Returns whether all went well.
template <typename Action>
bool reply(const Channel& channel, const Action& action) {
  ByteWriter out;
  bool good = true;
  try {
    out.put(Answer::done);
    action(out);
  } catch (const std::exception& error) {
    good = false;
    out = ByteWriter();
    out.put(dynamic_cast<const std::invalid_argument*>(&error) ? Answer::refused : Answer::failed);
    put(out, error.what());
  }
  return channel.send(out.take()) && good;
}

// Answers until it is told to quit or the parent is gone.
void serve(const Channel& channel, const fs::path& folder, const FmuDescription& description, const std::string& instance) {
  std::unique_ptr<ForeignFmu> fmu;
  if (!reply(channel, [&](ByteWriter&) { fmu = load_foreign_fmu(folder, description, instance); })) return;
  bool more = true;
  for (Bytes request; more && channel.receive(request, -1) == Channel::Received::message;) {
    reply(channel, [&](ByteWriter& out) { more = answer(*fmu, description, request, out); });
  }
}

[[noreturn]] void run_child(int socket, const fs::path& folder, const FmuDescription& description, const std::string& instance) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  // Ctrl-C reaches all processes of a terminal; the parent decides what is to end.
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGTERM, SIG_DFL);
  // An FMU that calls exit runs what this program has registered, last come first served: nothing of that is for a child.
  on_exit([](int status, void*) { _exit(status); }, nullptr);
  {
    const Channel channel(socket);
    serve(channel, folder, description, instance);
  }
  _exit(0);
}

// --- The parent ------------------------------------------------------------------------------------------------------

class FmuProcess final : public ForeignFmu {
 public:
  FmuProcess(const fs::path& folder, const FmuDescription& description, const std::string& instance, double patience)
      : description_(description), patience_(patience), outputs_(description.variables.size()) {
    int sockets[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, sockets) != 0) {
      throw std::runtime_error(fmt::format("no connection to a process for it: {}", std::strerror(errno)));
    }
    std::fflush(nullptr);  // what waits in buffers must not be written twice
    child_ = fork();
    if (child_ == 0) {
      close(sockets[0]);
      run_child(sockets[1], folder, description, instance);
    }
    const int error = errno;
    close(sockets[1]);
    channel_ = std::make_unique<Channel>(sockets[0]);
    if (child_ < 0) throw std::runtime_error(fmt::format("no process for it: {}", std::strerror(error)));
    try {
      receive(Call::load);
    } catch (...) {
      end();
      throw;
    }
  }
  ~FmuProcess() override { end(); }

  void enter_initialization_mode(double start) override {
    ByteWriter out = request(Call::enter_initialization);
    out.put(start);
    call(Call::enter_initialization, out.take());
  }
  void exit_initialization_mode() override { call(Call::exit_initialization); }
  Step step(double now, double length) override {
    ByteWriter out = request(Call::step);
    out.put(now);
    out.put(length);
    const Bytes reply = call(Call::step, out.take());
    ByteReader in(reply);
    in.get<Answer>();
    const double reached = in.get<double>();
    const bool terminate = in.get<bool>();
    keep_outputs(in);
    return {reached, terminate};
  }
  double get(const FmuVariable& variable) override {
    const std::size_t i = index(variable);
    if (outputs_known_ && variable.variable.causality == Causality::output) return outputs_[i];
    ByteWriter out = request(Call::read);
    out.put(static_cast<std::uint32_t>(i));
    const Bytes reply = call(Call::read, out.take());
    ByteReader in(reply);
    in.get<Answer>();
    const double value = in.get<double>();
    keep_outputs(in);
    return value;
  }
  void set(const FmuVariable& variable, double value) override {
    to_set_.emplace_back(static_cast<std::uint32_t>(index(variable)), value);
    outputs_known_ = false;
  }
  UnitState save() override {
    Bytes reply = call(Call::save);
    reply.erase(reply.begin());
    return reply;
  }
  void restore(const UnitState& state) override {
    to_set_.clear();
    ByteWriter out = request(Call::restore);
    out.put(static_cast<std::uint64_t>(state.size()));
    for (const std::byte byte : state) out.put(byte);
    call(Call::restore, out.take());
  }
  void terminate() override { call(Call::terminate); }
  void reset() override {
    to_set_.clear();
    call(Call::reset);
  }

 private:
  std::size_t index(const FmuVariable& variable) const {
    return static_cast<std::size_t>(&variable - description_.variables.data());
  }

  // The head of a message: what is to be set, and what is asked for.
  ByteWriter request(Call call) {
    ByteWriter out;
    out.put(static_cast<std::uint32_t>(to_set_.size()));
    for (const auto& [variable, value] : to_set_) {
      out.put(variable);
      out.put(value);
    }
    out.put(call);
    to_set_.clear();
    outputs_known_ = false;
    return out;
  }
  Bytes call(Call what) { return call(what, request(what).take()); }
  Bytes call(Call what, const Bytes& message) {
    if (child_ <= 0) throw std::runtime_error("its process is gone");
    // Where the other side is gone there is nothing to be received either, which tells more.
    (void)channel_->send(message);
    return receive(what);
  }

  Bytes receive(Call call) {
    Bytes reply;
    switch (channel_->receive(reply, patience_)) {
      case Channel::Received::message: break;
      case Channel::Received::nothing:
        wait();
        throw std::runtime_error(fmt::format("it did not come back from {} within {} s", harness::to_string(call), patience_));
      case Channel::Received::end: throw std::runtime_error(epitaph(call, wait()));
    }
    const std::string words(reinterpret_cast<const char*>(reply.data()) + 1, reply.size() - 1);
    switch (static_cast<Answer>(reply.front())) {
      case Answer::done: return reply;
      case Answer::refused: throw std::invalid_argument(words);
      case Answer::failed: throw std::runtime_error(words);
    }
    return reply;
  }

  static std::string epitaph(Call call, int status) {
    if (WIFSIGNALED(status)) {
      return fmt::format("it crashed in {}: {}", harness::to_string(call), strsignal(WTERMSIG(status)));
    }
    return fmt::format("it ended its process in {}, with exit code {}", harness::to_string(call), WEXITSTATUS(status));
  }

  int wait() {
    int status = 0;
    kill(child_, SIGKILL);  // who has closed the connection is ending or ought to; what it ended with stays
    while (waitpid(child_, &status, 0) < 0 && errno == EINTR) {
    }
    child_ = 0;
    return status;
  }

  void keep_outputs(ByteReader& in) {
    for (std::size_t i = 0; i < outputs_.size(); ++i) {
      if (description_.variables[i].variable.causality == Causality::output) in.get(outputs_[i]);
    }
    in.finish();
    outputs_known_ = true;
  }

  // The FMU may free itself, for a moment.
  void end() {
    if (child_ <= 0) return;
    to_set_.clear();
    Bytes none;
    if (channel_->send(request(Call::quit).take())) {
      while (channel_->receive(none, kPatienceAtTheEnd) == Channel::Received::message) {
      }
    }
    wait();
  }

  const FmuDescription& description_;
  const double patience_;
  std::unique_ptr<Channel> channel_;
  pid_t child_ = 0;  // 0: gone
  std::vector<std::pair<std::uint32_t, double>> to_set_;
  std::vector<double> outputs_;  // by variable
  bool outputs_known_ = false;
};

}  // namespace

std::unique_ptr<ForeignFmu> start_fmu_process(const fs::path& folder, const FmuDescription& description,
                                              const std::string& instance, double patience) {
  return std::make_unique<FmuProcess>(folder, description, instance, patience);
}

}  // namespace quayside::harness
