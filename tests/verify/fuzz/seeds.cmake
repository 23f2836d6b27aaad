# cmake -DIMPORTER=… -DFACETLESS=… -DSAMPLES=… -DOUTPUT=… -P seeds.cmake: writes the seeds of the fuzz targets,
# made from the project's own samples.
file(MAKE_DIRECTORY ${OUTPUT}/step_text ${OUTPUT}/iges_text ${OUTPUT}/model_file ${OUTPUT}/views ${OUTPUT}/mesh ${OUTPUT}/options ${OUTPUT}/http ${OUTPUT}/voxel_file)
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
  file(COPY ${OUTPUT}/model_file/${sample}.flm DESTINATION ${OUTPUT}/views)
endforeach()
file(WRITE ${OUTPUT}/options/views.json
     "{\"views\":[\"iso\",\"front\"],\"size\":\"64x48\",\"projection\":\"perspective\",\"samples\":4,\"precision\":\"fast\",\"threads\":2}")
file(WRITE ${OUTPUT}/options/camera.json
     "{\"camera\":[{\"name\":\"a\",\"eye\":[10,-20.5,3e1],\"target\":[0,0,0],\"up\":[0,0,1],\"projection\":\"orthographic\",\"height\":12},{\"eye\":[1,2,3],\"fov_y_deg\":40}],\"deflection\":1e-3,\"angular\":20,\"aov\":[\"depth\",\"face\"],\"audit\":true,\"fail_deviation_mm\":0.1}")
# CMake does not change line ends.
string(ASCII 13 10 end)
set(host "Host: localhost${end}")
file(WRITE ${OUTPUT}/http/page "GET /?a=b%20c HTTP/1.1${end}${host}Range: bytes=0-9${end}If-None-Match: \"x\"${end}Accept-Encoding: gzip${end}${end}")
set(body "--b${end}Content-Disposition: form-data; name=\"file\"; filename=\"a.step\"${end}${end}ISO-10303-21;${end}--b${end}Content-Disposition: form-data; name=\"options\"${end}${end}{\"view\":\"iso\",\"size\":\"8x8\"}${end}--b--${end}")
string(LENGTH "${body}" length)
file(WRITE ${OUTPUT}/http/multipart "POST /v1/comparisons HTTP/1.1${end}${host}Prefer: wait=1${end}Idempotency-Key: k${end}Content-Type: multipart/form-data; boundary=b${end}Content-Length: ${length}${end}${end}${body}")
set(body "{\"model\":\"0123456789012345678901234567890123456789012345678901234567890123\",\"view\":[\"front\"]}")
string(LENGTH "${body}" length)
file(WRITE ${OUTPUT}/http/json "POST /v1/renders HTTP/1.1${end}${host}Content-Type: application/json${end}Authorization: Bearer facetless_0_0${end}traceparent: 00-0123456789abcdef0123456789abcdef-0123456789abcdef-01${end}Content-Length: ${length}${end}${end}${body}")
file(WRITE ${OUTPUT}/http/chunked "POST /v1/models?name=a.step HTTP/1.1${end}${host}Content-Type: application/octet-stream${end}Transfer-Encoding: chunked${end}${end}5${end}ISO-1${end}3;x=y${end}030${end}0${end}${end}")
file(WRITE ${OUTPUT}/http/expect "POST /v1/models HTTP/1.1${end}${host}Expect: 100-continue${end}Content-Type: application/octet-stream${end}Content-Encoding: gzip${end}Content-Length: 4${end}${end}abcd")
# Voxel files of a few voxels. The bytes of the octree and of the column are letters, since CMake writes no zeros: the target
# completes the header of an octree.
file(WRITE ${OUTPUT}/voxel_file/labels.nrrd "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\nencoding: raw\n\nabcdefgh")
file(WRITE ${OUTPUT}/voxel_file/labels.vti "<VTKFile type=\"ImageData\" byte_order=\"LittleEndian\" header_type=\"UInt64\"><ImageData WholeExtent=\"0 1 0 1 0 1\" Origin=\"0 0 0\" Spacing=\"1 1 1\"><CellData><DataArray type=\"UInt8\" Name=\"material\" format=\"appended\" offset=\"0\"/></CellData></ImageData><AppendedData encoding=\"raw\">_12345678a</AppendedData></VTKFile>")
string(REPEAT "a" 80 letters)
file(WRITE ${OUTPUT}/voxel_file/tree.oct "FLVXOCT\n${letters}")
file(WRITE ${OUTPUT}/voxel_file/column.vxl "${letters}${letters}")
# CMake cannot write these, so the program does, if it is built.
if(EXISTS "${FACETLESS}")
  file(REMOVE_RECURSE ${OUTPUT}/slices)
  foreach(target voxel_file/slices.tif slices/)
    execute_process(COMMAND ${FACETLESS} convert ${OUTPUT}/voxel_file/labels.nrrd --out ${OUTPUT}/${target}
                    OUTPUT_QUIET ERROR_QUIET RESULT_VARIABLE failed)
    if(failed)
      message(FATAL_ERROR "${FACETLESS} wrote no ${target}")
    endif()
  endforeach()
  file(REMOVE ${OUTPUT}/voxel_file/slices.tif.json)
  file(RENAME ${OUTPUT}/slices/slice_0001.png ${OUTPUT}/voxel_file/slice.png)
endif()
