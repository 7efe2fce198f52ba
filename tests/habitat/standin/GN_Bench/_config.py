"""Configuration as yacs makes it: attributes, frozen until defrosted, new ones allowed."""


class Node:
    def __init__(self, **values):
        self.__dict__.update(values, _frozen=False)

    def __setattr__(self, name, value):
        if self._frozen:
            raise AttributeError("Attempted to set {} to {}, but CfgNode is immutable".format(name, value))
        self.__dict__[name] = value

    def _all(self, frozen):
        self.__dict__["_frozen"] = frozen
        for value in self.__dict__.values():
            if isinstance(value, Node):
                value._all(frozen)

    def freeze(self):
        self._all(True)

    def defrost(self):
        self._all(False)

    def clone(self):
        copies = {k: v.clone() if isinstance(v, Node) else v for k, v in self.__dict__.items() if k != "_frozen"}
        found = Node(**copies)
        found._all(self._frozen)
        return found


def get_config():
    camera = {"HEIGHT": 720, "WIDTH": 960, "HFOV": 70}
    simulator = Node(
        TYPE="Sim-v0",
        FORWARD_STEP_SIZE=0.25,
        TURN_ANGLE=10,
        COLLIDABLE=True,
        SCENE="data/scene_datasets/scenes/0001_839920",
        DOOR_TELEPORT=Node(ENABLED=True, TRIGGER_DISTANCE=0.5),
        AGENT_0=Node(HEIGHT=1.3, RADIUS=0.1, SENSORS=["RGB_SENSOR"]),
        RGB_SENSOR=Node(**camera),
        DEPTH_SENSOR=Node(**camera, MIN_DEPTH=0.0, MAX_DEPTH=10.0, NORMALIZE_DEPTH=True),
    )
    found = Node(SIMULATOR=simulator)
    found.freeze()
    return found
