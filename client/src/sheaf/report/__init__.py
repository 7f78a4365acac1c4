# SPDX-License-Identifier: MIT
"""Error against run time, stability and test counts of the engine on this machine (`sheaf-client report`).

Wants the extra: `pip install 'sheaf[report]'`.
"""

from ._plan import StudyOptions
from ._sample import write_sample
from ._study import SceneStudy, Study, study
from ._write import write_report

__all__ = ["SceneStudy", "Study", "StudyOptions", "study", "write_report", "write_sample"]
