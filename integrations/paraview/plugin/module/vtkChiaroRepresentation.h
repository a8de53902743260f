/**
 * @class vtkChiaroRepresentation
 * @brief image data in natural light
 *
 * The representation "Chiaro": as "Volume", drawn by vtkChiaroVolumeMapper. Over several processes each keeps ghost
 * cells, light is found together, in ProcessViewRequest, and the processes' pictures are composited by ParaView.
 */
#ifndef vtkChiaroRepresentation_h
#define vtkChiaroRepresentation_h

#include "vtkChiaroRepresentationModule.h"  // for export macro
#include "vtkImageVolumeRepresentation.h"

class VTKCHIAROREPRESENTATION_EXPORT vtkChiaroRepresentation : public vtkImageVolumeRepresentation {
public:
    static vtkChiaroRepresentation* New();
    vtkTypeMacro(vtkChiaroRepresentation, vtkImageVolumeRepresentation);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    int ProcessViewRequest(vtkInformationRequestKey* request, vtkInformation* in, vtkInformation* out) override;

    ///@{
    /**
     * As vtkChiaroVolumeMapper::SetSetting.
     */
    void SetSetting(const char* name, const char* value);
    void SetSetting(const char* name, double value);
    void SetSetting(const char* name, int value);
    ///@}
    /**
     * A setting that is on or off.
     */
    void SetSwitch(const char* name, int on);

    ///@{
    /**
     * Layers of ghost cells that each of several processes asks for; 8 by default.
     */
    void SetGhostLevels(int levels);
    vtkGetMacro(GhostLevels, int);
    ///@}

protected:
    vtkChiaroRepresentation();
    ~vtkChiaroRepresentation() override;

    int RequestUpdateExtent(vtkInformation* request, vtkInformationVector** in, vtkInformationVector* out) override;
    int RequestData(vtkInformation* request, vtkInformationVector** in, vtkInformationVector* out) override;

private:
    vtkChiaroRepresentation(const vtkChiaroRepresentation&) = delete;
    void operator=(const vtkChiaroRepresentation&) = delete;

    bool SetBlock();
    void FindLight(vtkInformation* in);

    int GhostLevels = 8;
    int Own[6] = {0, -1, 0, -1, 0, -1};  // extent of what is no ghost
};

#endif
