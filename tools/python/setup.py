"""The tag of the wheel: any Python 3, this machine's library and program."""

from setuptools import Distribution, setup
from wheel.bdist_wheel import bdist_wheel


class Binary(Distribution):
    def has_ext_modules(self):
        return True


class Wheel(bdist_wheel):
    def get_tag(self):
        return "py3", "none", self.plat_name.replace("-", "_").replace(".", "_")


setup(distclass=Binary, cmdclass={"bdist_wheel": Wheel})
