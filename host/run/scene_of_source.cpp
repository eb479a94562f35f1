#include "host/run/scene_of_source.h"

#include "host/survey/scene_survey.h"

namespace rosefusion {

std::optional<SceneMeasures> sceneOf(PeekedSource& source, const Settings& settings,
                                     const StopQuestion& stop) {
  if (!hasAutomatic(settings)) return {};
  const SequenceInfo& info = source.info();
  std::optional<SceneMeasures> scene = surveyScene(source.firstDepths(kSurveyedFrames, stop), info.intrinsics,
                                                   info.depth_units_per_metre, settings.depth);
  if (scene) scene->sensor = info.sensor;
  return scene;
}

}  // namespace rosefusion
