#include "tools/view/draw/timer.h"

#include "runtime/gl/check.h"

namespace ivory {

// Timestamps rather than GL_TIME_ELAPSED: one span holds several framebuffers, of which some drivers time the last
// alone.
void GpuTimer::begin() {
  // Results in the order of asking; what is not ready is asked again next time.
  for (std::size_t i = 0; i < spans_.size(); ++i) {
    Span& span = spans_[(next_ + i) % spans_.size()];
    if (!span.pending) continue;
    GLint ready = GL_FALSE;
    IVORY_GL(glGetQueryObjectiv, span.end.id(), GL_QUERY_RESULT_AVAILABLE, &ready);
    if (ready != GL_TRUE) break;
    GLuint64 begin = 0;
    GLuint64 end = 0;
    IVORY_GL(glGetQueryObjectui64v, span.begin.id(), GL_QUERY_RESULT, &begin);
    IVORY_GL(glGetQueryObjectui64v, span.end.id(), GL_QUERY_RESULT, &end);
    span.pending = false;
    milliseconds_ = float(double(end - begin) * 1e-6);
  }
  running_ = !spans_[next_].pending;
  if (!running_) return;
  if (!spans_[next_].begin) {
    spans_[next_].begin = gl::make<gl::Kind::query>();
    spans_[next_].end = gl::make<gl::Kind::query>();
  }
  IVORY_GL(glQueryCounter, spans_[next_].begin.id(), GL_TIMESTAMP);
}

void GpuTimer::end() {
  if (!running_) return;
  IVORY_GL(glQueryCounter, spans_[next_].end.id(), GL_TIMESTAMP);
  spans_[next_].pending = true;
  next_ = (next_ + 1) % spans_.size();
  running_ = false;
}

}  // namespace ivory
