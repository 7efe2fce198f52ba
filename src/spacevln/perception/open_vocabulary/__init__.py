"""Open-vocabulary perception: any landmark phrase in any picture, by published models (extra ``perception``).

Nothing here imports a deep-learning library before a model is opened (``opening.open_detector``).
"""
