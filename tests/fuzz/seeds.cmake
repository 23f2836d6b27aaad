# cmake -DIMPORTER=… -DSAMPLES=… -DOUTPUT=… -P seeds.cmake: the fuzz targets' seeds, made from the project's own samples.
file(MAKE_DIRECTORY ${OUTPUT}/step_text ${OUTPUT}/iges_text ${OUTPUT}/model_file ${OUTPUT}/mesh ${OUTPUT}/options)
file(COPY ${SAMPLES}/sphere.step ${SAMPLES}/trimmed.iges ${SAMPLES}/broken/mesh.stl DESTINATION ${OUTPUT})
file(RENAME ${OUTPUT}/sphere.step ${OUTPUT}/step_text/sphere.step)
file(RENAME ${OUTPUT}/trimmed.iges ${OUTPUT}/iges_text/trimmed.iges)
file(RENAME ${OUTPUT}/mesh.stl ${OUTPUT}/mesh/mesh.stl)
foreach(sample sphere torus)
  execute_process(COMMAND ${IMPORTER} ${SAMPLES}/${sample}.step --model ${OUTPUT}/model_file/${sample}.flm
                  --mesh ${OUTPUT}/mesh/${sample}.glb --deflection 0.1 OUTPUT_QUIET ERROR_QUIET RESULT_VARIABLE failed)
  if(failed)
    message(FATAL_ERROR "${IMPORTER} made no model of ${sample}.step")
  endif()
endforeach()
file(WRITE ${OUTPUT}/options/views.json
     "{\"views\":[\"iso\",\"front\"],\"size\":\"64x48\",\"projection\":\"perspective\",\"samples\":4,\"precision\":\"fast\",\"threads\":2}")
file(WRITE ${OUTPUT}/options/camera.json
     "{\"camera\":[{\"name\":\"a\",\"eye\":[10,-20.5,3e1],\"target\":[0,0,0],\"up\":[0,0,1],\"projection\":\"orthographic\",\"height\":12},{\"eye\":[1,2,3],\"fov_y_deg\":40}],\"deflection\":1e-3,\"angular\":20,\"aov\":[\"depth\",\"face\"],\"audit\":true,\"fail_deviation_mm\":0.1}")
